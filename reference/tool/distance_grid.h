// The signed distance of a triangle mesh as a smooth function: sampled once on a grid, then a tricubic spline.
#pragma once

#include "reference/tool/tool_gap.h"
#include "scene/mesh/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace touchstone::reference {

/// Facets of a bent surface should melt into one another, or every one of their edges would be a tight bend that costs
/// Newton iterations, yet keep the mesh's shape: a quarter of their typical short edge, up to a quarter of the mesh's
/// smallest extent. Flat faces between sharp edges should stay flat: a twentieth of that extent. In any case the grid
/// keeps below grid_points_max points. Measured on the mallet's tail, against an eighth of the edge: the whole edge 1.9
/// % of force, a half 0.4 %, a quarter 0.04 %.
[[nodiscard]] double grid_spacing_m(const scene::TriangleMesh& mesh);
inline constexpr double grid_points_max = 4e6;

/// Uniform cubic B-splines through the samples have two continuous derivatives; value, gradient and Hessian are those
/// of the one spline, so Newton converges. Away from edges its zero is the mesh's surface to a small fraction of the
/// spacing; edges are rounded over about one spacing. The gradient is of unit length only to that accuracy: contact
/// forces are lambda grad g with the gradient as it is, and nothing needs its length. Within two spacings of the
/// surface the samples are exact: distance to the nearest triangle, sign by the angle-weighted normal of the nearest
/// feature (J. A. Baerentzen, H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243-253). Farther off the nearest
/// triangle is handed on from point to point (R. Bridson, fast sweeping), which may miss it slightly. Beyond the grid
/// the gap is infinite.
class DistanceGrid final : public ToolDistance {
 public:
  DistanceGrid(const scene::TriangleMesh& mesh, double spacing_m);
  [[nodiscard]] Gap<3> at(const scene::Vec3& p_T_m) const override;
  [[nodiscard]] scene::Bounds bounds() const override { return bounds_; }
  [[nodiscard]] double half_width_m() const override;
  [[nodiscard]] bool faceted() const override { return true; }

 private:
  [[nodiscard]] std::size_t index(int i, int j, int k) const noexcept {
    return static_cast<std::size_t>((static_cast<std::int64_t>(k) * count_[1] + j) * count_[0] + i);
  }
  void sample(const scene::TriangleMesh& mesh);
  void to_coefficients();

  double spacing_m_;
  scene::Bounds bounds_;
  scene::Vec3 origin_m_;  // of the first grid point
  std::array<int, 3> count_{};
  std::vector<double> coefficient_m_;
};

/// The angle between the two faces at every edge [rad]; vertices of an edge in ascending order.
[[nodiscard]] std::map<std::pair<int, int>, double> edge_angles(const scene::TriangleMesh& mesh);
inline constexpr double sharp_angle = 0.5;  ///< no facets of a bent surface from here on

/// Angle-weighted outward normals of the vertices, not of unit length: they do not depend on how a flat face is cut.
[[nodiscard]] Eigen::Matrix3Xd vertex_normals(const scene::TriangleMesh& mesh);

}  // namespace touchstone::reference
