#include "fast/response/response_model.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

Columns columns_of(const Eigen::Matrix3Xd& points) {
  Columns out;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::VectorXf row = points.row(static_cast<Eigen::Index>(i)).transpose().cast<float>();
    out[i].assign(row.begin(), row.end());
  }
  return out;
}

bool alike(const LocalShape& a, const LocalShape& b, double reach_m) {
  constexpr double tolerance = 1e-6;  // of the height at the reach, over the reach
  return std::abs(a.height_m(reach_m) - b.height_m(reach_m)) < tolerance * reach_m;
}

}  // namespace

std::string response_needs(const scene::Scene& scene) {
  if (scene.contact.friction) return "the contact is without friction";
  if (!scene.tool.convex()) return "the tool is convex: it has one contact region";
  if (const scene::FoundTip tip = scene::tool_tip(scene); !tip.tip) return tip.why;
  return scene::load_grid(scene).why;
}

ResponseModel::ResponseModel(const scene::Scene& scene, const scene::Surface& surface, scene::Response given)
    : body(scene::body_shape(scene.body)),
      tip(scene::tool_tip(scene).tip.value()),
      response(std::move(given)),
      half_space(scene.body.material),
      rest_m(columns_of(surface.points_m)) {
  const scene::LoadGrid& grid = response.grid;
  const int n = grid.count();
  const double reach_m = tip.reach_m();
  own_compliance.resize(n);
  sway.resize(3, n);
  tilt.resize(3, n);
  for (int k = 0; k < n; ++k) {
    const Vec3 normal = grid.normals.col(k), own = response.own_m_per_n.col(k);
    own_compliance[k] = -own.dot(normal);
    sway.col(k) = own - own.dot(normal) * normal;
    const Vec3 slope = grid.axes.leftCols<2>() * response.tilt_per_n.col(k);
    tilt.col(k) = slope - slope.dot(normal) * normal;
    local.push_back(local_shape(*body, grid.points_m.col(k), normal, 0.8 * reach_m));
  }
  const bool same = std::all_of(local.begin(), local.end(),
                                [&](const LocalShape& one) { return alike(one, local.front(), reach_m); });
  const FiniteStrain strain = finite_strain(scene.body.material.poissons_ratio);
  for (int k = 0; k < (same ? 1 : n); ++k) {
    tables.emplace_back(tip, local[static_cast<std::size_t>(k)], scene.body.material.contact_modulus_pa(), strain);
  }
  const double held_below_m = scene.body.flat_bottom() ? 0.0 : scene.body.support_height_m;
  const double touching_m = 1e-9 * scene::body_size_m(scene.body);
  for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
    free.push_back(surface.points_m(2, i) <= held_below_m + touching_m ? 0.0f : 1.0f);
  }
}

std::size_t ResponseModel::memory_bytes() const noexcept {
  std::size_t bytes = (rest_m[0].size() * 3 + free.size()) * sizeof(float) +
                      static_cast<std::size_t>(response.smooth_m_per_n.size()) * sizeof(float) +
                      static_cast<std::size_t>(own_compliance.size()) * (1 + 6 + 11) * sizeof(double);
  for (const ContactTable& table : tables) bytes += table.memory_bytes();
  return bytes;
}

std::string status_text(ResponseStatus status) {
  const auto bits = static_cast<std::uint32_t>(status);
  std::string text;
  const auto add = [&](ResponseStatus bit, const char* words) {
    if ((bits & static_cast<std::uint32_t>(bit)) != 0) text += (text.empty() ? "" : ", ") + std::string(words);
  };
  add(ResponseStatus::not_finite, "a pose that is not finite");
  add(ResponseStatus::outside_grid, "the load left the grid of the response");
  add(ResponseStatus::too_deep, "deeper than the tool's tip");
  add(ResponseStatus::tilted, "the flat tip is tilted");
  return text.empty() ? "ok" : text;
}

ResponseState::ResponseState(const ResponseModel& model) : near(model.rest_m[0].size()) {
  for (std::vector<float>& column : displacement_m) column.assign(model.rest_m[0].size(), 0.0f);
}

std::size_t ResponseState::memory_bytes() const noexcept {
  return near.size() * (sizeof(std::int32_t) + 3 * sizeof(float));
}

}  // namespace touchstone::fast
