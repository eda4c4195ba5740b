// What a scene is reduced to before anything is solved: symmetry, meshes, and what cannot be done.
#pragma once

#include "reference/discretisation/discretisation.h"
#include "reference/mesh/following_grid.h"
#include "reference/run/contact_patch.h"
#include "scene/base/error.h"
#include "scene/model/plan.h"
#include "scene/model/scene.h"

#include <memory>
#include <string>
#include <tuple>
#include <vector>

namespace touchstone::reference {

/// The smallest model that answers the whole scene.
struct ModelChoice {
  int dim = 3;                              ///< 2: body of revolution in its meridian plane
  bool mirror_x = false, mirror_y = false;  ///< dim = 3: solved on x >= 0, on y >= 0 only
  std::shared_ptr<const ToolDistance> tool;
  std::vector<ContactPatch> contacts;  ///< of all instants, those deeper than a tenth of the deepest
  double half_width_m = 0.0;           ///< of the deepest contact
  /// The coarse grid of all meshes, of `dim` directions, where their cells follow the inclusions.
  std::tuple<std::shared_ptr<const FollowingGrid<2>>, std::shared_ptr<const FollowingGrid<3>>> following;
  std::string why_cut;  ///< why the cells do not follow the inclusions
  template <int dimension>
  [[nodiscard]] const std::shared_ptr<const FollowingGrid<dimension>>& following_grid() const {
    return std::get<dimension - 2>(following);
  }
  [[nodiscard]] bool follows() const { return std::get<0>(following) || std::get<1>(following); }
  [[nodiscard]] std::string name(scene::Kinematics kinematics) const;  ///< "quarter 3D u-p finite strain"
};

/// A body of revolution, inclusions and all, under a tool that is one about the same axis all along the track is
/// axisymmetric. Otherwise the body is mirrored in x = 0 and y = 0 where the inclusions, and the tool all along the
/// track, are their own mirror image. Tools are compared to a millionth of their size, at the waypoints, the instants,
/// and a place between any two of them.
[[nodiscard]] ModelChoice choose_model(const scene::Scene& scene);

/// Finds ModelChoice::following, as choose_model() does; again where `dim` or the mirrors are changed after it.
void follow_inclusions(const scene::Scene& scene, ModelChoice& choice);

/// What of the scene this solver cannot do.
/// A cylinder's fillet must be smallest_fillet_share of its radius: sharper pins were seen to stop converging.
[[nodiscard]] std::vector<scene::Fault> unsupported_parts(const scene::Scene& scene);
inline constexpr double smallest_fillet_share = 0.25;

/// Hertz's contact radius sqrt(R d) of two curved surfaces, capped by the tool's own radius: where small cells are
/// needed. 1/R is the sum of the curvatures of tool and body.
[[nodiscard]] double expected_contact_radius_m(const scene::Scene& scene, double depth_m);

/// How much smaller the cells under the tool are on a level than on level 0: 1, 2, 4, ... Ratios in between would need
/// another coarse grid, and so another far field, which the differences of the levels would show as if it were theirs.
[[nodiscard]] double refinement(int level);

/// How much smaller the cells far from the contact are than on level 0: a fourth root of the refinement, in whole
/// halvings, since an octree would round anything in between down.
[[nodiscard]] double far_share(int level);

/// Edge of the cells at the rim of the deepest contact on a level, 0 the coarsest, as requested: octree cells are down
/// to half of it, by the same ratio on every level. Cells are smaller towards the middle, so that shallower contacts
/// are resolved by as many cells as the deepest, down to a tenth of its depth; and smaller where the tool bends
/// tightly: rim_share of the bend's radius on the coarsest level, but at least a sixteenth of the others. From
/// scene.reference.element_size_m; automatic: a / 1.5 in three dimensions, a / 4 in two.
[[nodiscard]] double element_size_m(const scene::Scene& scene, const ModelChoice& choice, int level);
inline constexpr double rim_share = 0.4;

/// Factors on the usual sizes of the cells, to see what they matter.
struct MeshChange {
  double far_field = 1.0;   ///< growth with the distance, and the largest cell
  double inclusions = 1.0;  ///< cells at the surfaces of inclusions
};

/// Mesh of the refinement sequence, inclusions in it. Under the tool cells shrink by refinement(level); away from it
/// they grow with the distance, and both that growth and the largest cell shrink by far_share(level): finer
/// everywhere, though not by the same factor. The smooth far field of quadratic elements needs no more. Refined like
/// the contact are the cells at the surface of an inclusion and at the edge of a round body's support, where the
/// displacement has a singular gradient: 1/32 of half the body's size there on the coarsest level in two dimensions,
/// 1/8 in three. Measured on a ball on a ball in two dimensions, 1/8 to 1/64 all give the force of 1/512 to 0.07 %.
template <int dim>
[[nodiscard]] Discretisation<dim> level_mesh(const scene::Scene& scene, const ModelChoice& choice, int level,
                                             const MeshChange& change = {});

}  // namespace touchstone::reference
