// Measures of a rest surface moved by one displacement per rest point.
#pragma once

#include "reference/tool/tool_gap.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

namespace touchstone::compare {

/// Volume enclosed by the triangles after the move [m^3]: a sixth of the sum of a . (b x c), by the divergence
/// theorem. The surface must be closed; vertices doubled at an edge must move equally.
[[nodiscard]] double enclosed_volume_m3(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m);

/// Largest distance from a vertex of one moved surface to the triangles of the other, in both directions [m]. Exact for
/// the vertices; the inside of a triangle may be farther by the sag of one triangle. NaN when a place is not finite.
[[nodiscard]] double hausdorff_m(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_a_m,
                                 const Eigen::Matrix3Xd& displacement_b_m);

/// Unit normals of the moved surface at its vertices: the mean of the adjacent moved triangles' by area, turned as the
/// rest triangles' mean must be to give the shape's own normal, so that an unmoved surface has that. A vertex whose
/// triangles are crushed keeps the rest normal.
[[nodiscard]] Eigen::Matrix3Xd moved_normals(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m);

/// Angle between each pair of columns [rad], 0 to pi.
[[nodiscard]] Eigen::VectorXd angles_rad(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b);

/// Signed distance of every moved rest point from the tool's surface [m], negative inside the tool, infinite far away.
[[nodiscard]] Eigen::VectorXd tool_gaps_m(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m,
                                          const reference::ToolDistance& tool, const scene::Pose& pose);

}  // namespace touchstone::compare
