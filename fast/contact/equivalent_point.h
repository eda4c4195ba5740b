// The point contact that is equivalent to a whole region, section IV-C.
#pragma once

#include "fast/contact/contact_detection.h"
#include "scene/shape/shape.h"

namespace touchstone::fast {

/// Where the equivalent point contact starts.
struct DeformationOrigin {
  scene::Vec3 p0_W_m = scene::Vec3::Zero();   ///< origin of deformation, on the rest surface
  scene::Vec3 normal = scene::Vec3::UnitZ();  ///< of the rest surface there
  int patch = 0;                              ///< of the rest surface
};

/// Origin of deformation p0: the geometric centre of the region's projection on the rest surface along d, moved to
/// the surface along -d (on a curved surface the centre of surface points lies a little beneath it).
/// The deformation displacement D at p0 is DuffingLaw::depth_m of the region's force.
[[nodiscard]] DeformationOrigin deformation_origin(const scene::Shape& body, ExitDistance exit_distance_m,
                                                   const scene::Vec3& d, const RegionExtent& extent) noexcept;

/// The rest surface's point nearest to p_W_m as an origin of deformation.
[[nodiscard]] DeformationOrigin origin_at(const scene::Shape& body, const scene::Vec3& p_W_m) noexcept;

/// No point is deeper than this part of the body's local thickness (RegionExtent::thickness_m): beyond it the rest
/// shape does not determine the force, and the depth is limited.
inline constexpr double depth_limit_rel = 0.5;

/// Limits every d_i. @returns true where a depth was limited
bool limit_depths(double limit_m, RegionPoints& points) noexcept;

}  // namespace touchstone::fast
