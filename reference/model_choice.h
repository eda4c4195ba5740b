// What a scene is reduced to before anything is solved: symmetry, meshes, and what cannot be done.
#pragma once

#include "reference/contact_patch.h"
#include "reference/mesh.h"
#include "scene/error.h"
#include "scene/plan.h"
#include "scene/scene.h"

#include <string>
#include <vector>

namespace touchstone::reference {

/// The smallest model that answers the whole scene.
struct ModelChoice {
  int dim = 3;                              ///< 2: body of revolution in its meridian plane
  bool mirror_x = false, mirror_y = false;  ///< dim = 3: solved on x >= 0, on y >= 0 only
  std::shared_ptr<const ToolDistance> tool;
  std::vector<ContactPatch> contacts;  ///< of all instants, those deeper than a tenth of the deepest
  double half_width_m = 0.0;           ///< of the deepest contact
  [[nodiscard]] std::string name(scene::Kinematics kinematics) const;  ///< "quarter 3D u-p finite strain"
};

/// A sphere body under a tool that is a body of revolution about the same axis all along the track is axisymmetric. A
/// box is mirrored in every plane through its axis that is a mirror plane of the tool all along the track. Tool and
/// planes are compared to a millionth of the tool's size, at the waypoints, the instants, and a place between any two
/// of them.
[[nodiscard]] ModelChoice choose_model(const scene::Scene& scene);

/// What of the scene this solver cannot do.
/// A cylinder's fillet must be smallest_fillet_share of its radius: sharper pins were seen to stop converging.
[[nodiscard]] std::vector<scene::Fault> unsupported_parts(const scene::Scene& scene);
inline constexpr double smallest_fillet_share = 0.25;

/// Hertz's contact radius sqrt(R d) of two curved surfaces, capped by the tool's own radius: where small cells are
/// needed. 1/R is the sum of the curvatures of tool and body.
[[nodiscard]] double expected_contact_radius_m(const scene::Scene& scene, double depth_m);

/// Edge of the cells at the rim of the deepest contact on a level, 0 the coarsest; each level halves it. Cells are
/// smaller towards the middle, so that shallower contacts are resolved by as many cells as the deepest, down to a
/// tenth of its depth; and smaller where the tool bends tightly: rim_share of the bend's radius on the coarsest level,
/// but at least a sixteenth of the others. From scene.reference.element_size_m; automatic: a / 1.5 in three dimensions,
/// a / 4 in two.
[[nodiscard]] double element_size_m(const scene::Scene& scene, const ModelChoice& choice, int level);
inline constexpr double rim_share = 0.4;

/// Meshes of the refinement sequence. Under the tool every level halves the cells; away from it cells grow with the
/// distance, and both that growth and the largest cell shrink by 2^(1/3) a level: finer everywhere, though not by the
/// same factor. The smooth far field of quadratic elements needs no more.
[[nodiscard]] Mesh<3> box_level(const scene::Scene& scene, const ModelChoice& choice, int level);
/// The same for a ball, whose support's edge is refined too: the displacement has a singular gradient there.
[[nodiscard]] Mesh<2> ball_level(const scene::Scene& scene, const ModelChoice& choice, int level);

}  // namespace touchstone::reference
