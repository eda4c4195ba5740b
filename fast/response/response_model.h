// The constant data of the response model, built once from a scene and its response, and what a step writes.
//
// The tool at depth D over the surface's point p0 presses with F:
//   D = D_hs(F) + C(p0 - F m) F.
// D_hs is the local law (contact_table.h), C(p) the normal part of the smooth response at a load's own place. m is how
// far the load moves over the body's surface per newton: the surface slopes by b and sways by s under it, so a ball of
// radius R touches F (R b - s) away from below its centre. Force and lateral force have one potential.
#pragma once

#include "fast/response/contact_table.h"
#include "fast/response/spread_load.h"
#include "scene/base/wrench.h"
#include "scene/response/response.h"
#include "scene/response/tool_tip.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::fast {

/// Why the response model cannot answer a scene, completing "the response model needs that ..."; empty when it can.
[[nodiscard]] std::string response_needs(const scene::Scene& scene);

struct ResponseModel {
  /// @param scene     one that response_needs() nothing
  /// @param surface   its rest surface, whose points are the response's
  ResponseModel(const scene::Scene& scene, const scene::Surface& surface, scene::Response response);

  std::unique_ptr<const scene::Shape> body;
  scene::ToolTip tip;
  scene::Response response;
  HalfSpace half_space;
  Columns rest_m;
  std::vector<float> free;           ///< 0 where the surface is held, else 1
  Eigen::VectorXd own_compliance;    ///< C at the grid's points [m/N]
  Eigen::Matrix3Xd sway, tilt;       ///< s [m/N] and the slope's direction b [1/N] there, world
  std::vector<LocalShape> local;     ///< of the body there
  std::vector<ContactTable> tables;  ///< one per grid point; one alone where the body is the same everywhere
  double largest_depth_m = 0.0;      ///< what the model was built for

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// What went other than planned in a step of the response model: bits, 0 for none.
enum class ResponseStatus : std::uint32_t {
  ok = 0,
  not_finite = 1u << 0,    ///< the pose was not a finite placement; the last answer was held
  outside_grid = 1u << 1,  ///< the load is outside the grid of the response; its nearest place was used
  too_deep = 1u << 2,      ///< deeper than the tip is high, or more than the model was built for
  tilted = 1u << 3,        ///< a flat tip that does not lie flat
};
[[nodiscard]] constexpr ResponseStatus operator|(ResponseStatus a, ResponseStatus b) noexcept {
  return static_cast<ResponseStatus>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
[[nodiscard]] std::string status_text(ResponseStatus status);

/// The contact of a step, in numbers.
struct ResponseContact {
  double depth_m = 0.0;        ///< D
  double indentation_m = 0.0;  ///< D - C F
  double energy_j = 0.0;       ///< the potential: work of a quasi-static press to here
  scene::Touch at{};           ///< p0
  SpreadLoad load;             ///< F, its place on the rest surface and its patch
};

/// Everything that a step writes; all storage is taken at construction.
struct ResponseState {
  explicit ResponseState(const ResponseModel& model);

  ResponseContact contact;
  scene::Wrench wrench;    ///< on the tool
  Columns displacement_m;  ///< of the rest points
  bool deformed = false;
  std::vector<std::int32_t> near;  ///< vertices near the load

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

}  // namespace touchstone::fast
