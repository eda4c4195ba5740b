#include "scene/response/response.h"

#include "scene/base/hash.h"
#include "scene/model/body_text.h"
#include "scene/response/find_tips.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <vector>

namespace touchstone::scene {
namespace {

/// Raised with every change of method that moves a response.
constexpr const char* method_version = "touchstone response method 3";

template <class Matrix>
std::string hash_of(const Matrix& matrix) {
  return hash_text(
      {reinterpret_cast<const char*>(matrix.data()), static_cast<std::size_t>(matrix.size()) * sizeof *matrix.data()});
}

}  // namespace

LoadKinds load_kinds(const Scene& scene) {
  const std::vector<ToolTip> tips = tool_tips(scene).tips;
  return {.friction = scene.contact.friction.has_value(),
          .ball = std::any_of(tips.begin(), tips.end(), [](const ToolTip& tip) { return tip.round(); })};
}

std::string response_needs(const Scene& scene) { return load_grid(scene).why; }

std::string formulation_needs(const Scene& scene) {
  return scene.fast.formulation == Formulation::response ? response_needs(scene) : "";
}

std::string response_identity(const Body& body, const LoadGrid& grid, const Surface& surface, const LoadKinds& loads) {
  std::ostringstream text;
  text << std::setprecision(17) << method_version << '\n' << body_text(body);
  text << (loads.friction ? "loads in 3 directions " : "loads ") << grid.counts[0] << " x " << grid.counts[1]
       << " places " << hash_of(grid.points_m) << '\n'
       << "rest points " << surface.vertex_count() << " places " << hash_of(surface.points_m) << '\n';
  if (loads.ball) text << "with double forces\n";
  return text.str();
}

}  // namespace touchstone::scene
