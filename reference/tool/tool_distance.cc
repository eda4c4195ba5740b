#include "reference/tool/tool_distance.h"

#include "reference/tool/distance_grid.h"
#include "scene/base/in_space.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace touchstone::reference {
namespace {

using scene::Bounds;
using scene::Mat3;
using scene::Vec3;

/// Curvatures near a centre of curvature are limited to this many over the half width.
constexpr double steepest = 1e3;

class Ball final : public ToolDistance {
 public:
  Ball(const Vec3& center_m, double radius_m) : center_m_(center_m), radius_m_(radius_m) {}
  [[nodiscard]] Gap<3> at(const Vec3& p_T_m) const override {
    const Vec3 from_center_m = p_T_m - center_m_;
    const double distance_m = from_center_m.norm();
    // At the centre all directions are equivalent; take the tool's lowest point.
    const Vec3 n = distance_m > 0.0 ? Vec3(from_center_m / distance_m) : Vec3(-Vec3::UnitZ());
    return {distance_m - radius_m_, n,
            (Mat3::Identity() - n * n.transpose()) / std::max(distance_m, radius_m_ / steepest)};
  }
  [[nodiscard]] Bounds bounds() const override {
    return {center_m_ - Vec3::Constant(radius_m_), center_m_ + Vec3::Constant(radius_m_)};
  }
  [[nodiscard]] double half_width_m() const override { return radius_m_; }

 private:
  Vec3 center_m_;
  double radius_m_;
};

/// Distance to all points within round_m of a core: a cylinder about z, or a segment for a capsule.
class RoundCylinder final : public ToolDistance {
 public:
  RoundCylinder(const Vec3& center_m, double core_radius_m, double core_half_m, double round_m)
      : center_m_(center_m), core_radius_m_(core_radius_m), core_half_m_(core_half_m), round_m_(round_m) {}
  [[nodiscard]] Gap<3> at(const Vec3& p_T_m) const override {
    const Vec3 p_m = p_T_m - center_m_;
    const double r_m = std::hypot(p_m.x(), p_m.y());
    const Vec3 radial = r_m > 0.0 ? Vec3(p_m.x() / r_m, p_m.y() / r_m, 0.0) : Vec3(Vec3::UnitX());
    const Vec3 up = p_m.z() < 0.0 ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitZ());
    const Vec3 around = Vec3::UnitZ().cross(radial);
    const double beyond_side_m = r_m - core_radius_m_, beyond_end_m = std::abs(p_m.z()) - core_half_m_;
    const double smallest_m = half_width_m() / steepest;
    const bool needle = core_radius_m_ == 0.0;
    if (beyond_end_m > 0.0 && (beyond_side_m > 0.0 || needle)) {
      const double distance_m = std::hypot(beyond_side_m, beyond_end_m);
      const Vec3 n = (beyond_side_m * radial + beyond_end_m * up) / distance_m;
      const Vec3 along = (beyond_end_m * radial - beyond_side_m * up) / distance_m;
      const double share_around = needle ? 1.0 : beyond_side_m / r_m;
      return {
          distance_m - round_m_, n,
          (along * along.transpose() + share_around * around * around.transpose()) / std::max(distance_m, smallest_m)};
    }
    if (beyond_side_m >= beyond_end_m) {
      return {beyond_side_m - round_m_, radial, around * around.transpose() / std::max(r_m, smallest_m)};
    }
    return {beyond_end_m - round_m_, up, Mat3::Zero()};
  }
  [[nodiscard]] Bounds bounds() const override {
    const double side_m = core_radius_m_ + round_m_;
    const Vec3 reach_m(side_m, side_m, core_half_m_ + round_m_);
    return {center_m_ - reach_m, center_m_ + reach_m};
  }
  [[nodiscard]] double half_width_m() const override {
    return std::min(core_radius_m_ + round_m_, core_half_m_ + round_m_);
  }

 private:
  Vec3 center_m_;
  double core_radius_m_, core_half_m_, round_m_;
};

/// Distance to all points within round_m of a core box.
class RoundBox final : public ToolDistance {
 public:
  RoundBox(const Vec3& center_m, const Vec3& core_half_m, double round_m)
      : center_m_(center_m), core_half_m_(core_half_m), round_m_(round_m) {}
  [[nodiscard]] Gap<3> at(const Vec3& p_T_m) const override {
    const Vec3 p_m = p_T_m - center_m_;
    const Vec3 side = p_m.unaryExpr([](double x) { return x < 0.0 ? -1.0 : 1.0; });
    const Vec3 beyond_m = p_m.cwiseAbs() - core_half_m_;
    const Vec3 outside_m = beyond_m.cwiseMax(0.0);
    const double distance_m = outside_m.norm();
    if (distance_m > 0.0) {
      const Vec3 n = side.cwiseProduct(outside_m) / distance_m;
      const Vec3 round = (beyond_m.array() > 0.0).cast<double>();
      return {distance_m - round_m_, n,
              (Mat3(round.asDiagonal()) - n * n.transpose()) / std::max(distance_m, half_width_m() / steepest)};
    }
    int axis = 0;
    const double nearest_m = beyond_m.maxCoeff(&axis);
    return {nearest_m - round_m_, side[axis] * Vec3::Unit(axis), Mat3::Zero()};
  }
  [[nodiscard]] Bounds bounds() const override {
    const Vec3 reach_m = core_half_m_ + Vec3::Constant(round_m_);
    return {center_m_ - reach_m, center_m_ + reach_m};
  }
  [[nodiscard]] double half_width_m() const override { return core_half_m_.minCoeff() + round_m_; }

 private:
  Vec3 center_m_, core_half_m_;
  double round_m_;
};

/// The grid of the mesh, kept from the last call. It takes seconds, and a scene's model, its errors and the next
/// contact of a study ask for the same mesh.
std::shared_ptr<const ToolDistance> distance_grid(const scene::TriangleMesh& mesh) {
  static std::mutex one_at_a_time;
  static scene::TriangleMesh last;
  static std::shared_ptr<const ToolDistance> grid;
  const std::lock_guard lock(one_at_a_time);
  if (!grid || last.triangles != mesh.triangles || last.points_m.cols() != mesh.points_m.cols() ||
      last.points_m != mesh.points_m) {
    grid = std::make_shared<DistanceGrid>(mesh, grid_spacing_m(mesh));
    last = mesh;
  }
  return grid;
}

}  // namespace

std::shared_ptr<const ToolDistance> tool_distance(const scene::Tool& tool) {
  const Vec3 center_T_m = -tool.mass_center_m.value_or(Vec3::Zero());
  switch (tool.shape) {
    case scene::ToolShape::sphere:
      return std::make_shared<Ball>(center_T_m, tool.radius_m);
    case scene::ToolShape::capsule:
      return std::make_shared<RoundCylinder>(center_T_m, 0.0, 0.5 * tool.length_m, tool.radius_m);
    case scene::ToolShape::cylinder:
      return std::make_shared<RoundCylinder>(center_T_m, tool.radius_m - tool.edge_radius_m,
                                             0.5 * tool.length_m - tool.edge_radius_m, tool.edge_radius_m);
    case scene::ToolShape::box: {
      const Vec3 half_m = 0.5 * tool.size_m;
      const double round_m = box_edge_share * half_m.minCoeff();
      return std::make_shared<RoundBox>(center_T_m, half_m - Vec3::Constant(round_m), round_m);
    }
    case scene::ToolShape::mesh:
      return distance_grid(scene::tool_mesh(tool));
  }
  return nullptr;
}

template <int dim>
RigidTool<dim> ball_tool(double radius_m, const Eigen::Matrix<double, dim, 1>& center_m) {
  scene::Tool tool;
  tool.radius_m = radius_m;
  scene::Pose pose;
  pose.position_m = scene::in_space<dim>(center_m);
  return {tool_distance(tool), pose};
}

template RigidTool<2> ball_tool(double, const Eigen::Vector2d&);
template RigidTool<3> ball_tool(double, const Eigen::Vector3d&);

}  // namespace touchstone::reference
