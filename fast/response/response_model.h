// The constant data of the response model, built once from a scene and its response, and what a step writes.
//
// A tip of the tool at depth D over the surface's point p0 presses with F:
//   D = D_hs(F) + C(p0 - F m) F.
// D_hs is the local law (contact_table.h), C(p) the normal part of the smooth response at a load's own place. m is how
// far the load moves over the body's surface per newton: the surface slopes by b and sways by s under it, so a ball of
// radius R touches F (R b - s) away from below its centre. Force and lateral force have one potential.
//
// Several tips press each other's places down:
//   D_i = D_hs(F_i) + C(p_i - F_i m_i) F_i + sum_j C_ij F_j,   F_i >= 0,
// C_ij = C_ji = (1 - nu^2) / (pi E |p_i - p_j|) and the rest from the columns, by Maxwell's and Betti's reciprocity.
// All have one potential, so the order of the tips does not matter.
//
// In the shape, the columns act where the tool is, F s away from the load's place at rest: the force's line of action
// moves with the body. Without friction the pressure leans with the surface; its part along it is a shear of the patch,
// which two columns of the grid's middle carry. Under and beside a ball BallField (finite_strain.h) adds what finite
// strain and the body's curvature do, and columns of double forces the body's answer to that.
//
// Next to an inclusion C falls off within the contact. Then a contact of radius a has C / sqrt(1 + (kappa a)^4) in its
// place: C under a small contact, ~ 1 / a^2 as under an even load under a large one. a = 3 F / (4 E* D_hs) is that of
// Hertz's contact. kappa, fast.body_falloff_per_m, is fitted; 0 leaves C.
//
// With friction, the tool's motion along the surface is the sum of the contact's displacement on the half space
// (slip_springs.h) and the body's, F s + C_t Q. On the rest surface the load lags behind the tool by the displacement
// that friction causes: C_t Q and the contact's. The surface under a ball is the one that this displacement has
// moved there, and the pressure's middle leads the ball by a share of the contact's: its forces turn with the normal.
#pragma once

#include "fast/realtime/stage_clock.h"
#include "fast/response/checked_range.h"
#include "fast/response/contact_table.h"
#include "fast/response/slip_springs.h"
#include "fast/response/spread_load.h"
#include "fast/surface/normals.h"
#include "fast/surface/surface_patches.h"
#include "scene/base/wrench.h"
#include "scene/response/grid_weights.h"
#include "scene/response/response.h"
#include "scene/response/tool_tip.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace touchstone::fast {

/// A tip of the tool and its local law.
struct TipLaw {
  scene::ToolTip tip;
  std::vector<LocalShape> local;     ///< of the body at the grid's points
  std::vector<ContactTable> tables;  ///< one per grid point; one alone where the body is the same everywhere
  int patches = 1;                   ///< of the load: round ones along a line
};

struct ResponseModel {
  /// @param scene    one of which scene::response_needs() nothing
  /// @param surface  its rest surface, whose points are the response's
  ResponseModel(const scene::Scene& scene, scene::Surface surface, scene::Response response);

  std::unique_ptr<const scene::Shape> body;
  scene::Surface surface;
  std::vector<TipLaw> tips;
  scene::Response response;
  HalfSpace half_space;
  BallField field;
  Columns3 rest_m, rest_normal;
  NormalStencils normals;
  std::vector<float> free;         ///< 0 where the surface is held, else 1
  Eigen::VectorXd own_compliance;  ///< C at the grid's points [m/N]
  Eigen::Matrix3Xd sway, tilt;     ///< s [m/N] and the slope's direction b [1/N] there, world
  double body_size_m;
  double falloff_per_m;  ///< kappa
  CheckedRange checked;
  Eigen::VectorXd edge_distance_m;  ///< from the grid's points to the nearest edge; infinite where there is none
  Eigen::VectorXd largest_curvature_per_m;  ///< of the body there, over all directions, without its sign
  // Only with several tips:
  Eigen::MatrixXd
      cross_compliance;  ///< C_ij between grid points without the half space's part; its diagonal is C [m/N]
  // Only with friction:
  std::optional<SlipSprings> springs;
  std::vector<Eigen::Matrix3d> shear_compliance;  ///< C_t at the grid's points, world [m/N]

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// How a load moves with its force, in the grid's coordinates.
struct LoadPath {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< at no force, in steps
  Eigen::Vector2d per_n = Eigen::Vector2d::Zero();  ///< steps per newton
};

/// The contact of a tip in a step, in numbers.
struct ResponseContact {
  double depth_m = 0.0;        ///< D
  double indentation_m = 0.0;  ///< D without what the body yields
  scene::Touch at{};           ///< p0
  SpreadLoad load;             ///< F, its place on the rest surface and its patch
  LocalContact law;
  scene::GridWeights weights;  ///< of p0
  LoadPath path;
  scene::Vec3 sway_m_per_n = scene::Vec3::Zero(), tilt_per_n = scene::Vec3::Zero(), shift_m_per_n = scene::Vec3::Zero();
  double curvature_per_m = 0.0;                   ///< of the body
  double compliance_m_per_n = 0.0;                ///< C of this force and radius
  double yielding = 0.0;                          ///< d(C F) / d(indentation)
  scene::Wrench wrench;                           ///< its part
  scene::Vec3 half_line_m = scene::Vec3::Zero();  ///< of a line: from the load's centre to the last patch's, world
  // Only with friction:
  scene::Vec3 friction_n = scene::Vec3::Zero();  ///< on the tool
  scene::Vec3 stretch_m = scene::Vec3::Zero();   ///< by which friction moves the surface at the load
  scene::Vec3 lead_m = scene::Vec3::Zero();      ///< by which friction moves the contact's middle over the ball

  /// By which the surface at the load has moved along itself: the tool is there.
  [[nodiscard]] scene::Vec3 moved_m() const noexcept { return stretch_m + law.force_n * sway_m_per_n; }
  [[nodiscard]] bool touches() const noexcept { return load.force_n > 0.0; }
};

/// Everything that a step writes; all storage is taken at construction.
struct ResponseState {
  explicit ResponseState(const ResponseModel& model);

  std::vector<ResponseContact> contacts;  ///< of the tips
  double energy_j = 0.0;                  ///< the potential: work of a quasi-static press to here
  scene::Wrench wrench;                   ///< on the tool
  SurfaceField field;
  bool deformed = false;
  std::vector<std::int32_t> near;        ///< vertices near the loads, as many for each tip as there are
  std::vector<std::int32_t> near_count;  ///< per tip
  Columns3 other_m;                      ///< of one more load; only with several tips or a line
  Eigen::VectorXd column_weight;         ///< of a load, at the grid's points
  std::unique_ptr<SlipState> slip;       ///< from tick to tick; null without friction
  StageClock* clock = nullptr;           ///< times of the stages, if wanted

  void lap(Stage stage) noexcept {
    if (clock != nullptr) clock->lap(stage);
  }

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

}  // namespace touchstone::fast
