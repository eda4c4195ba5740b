#include "compare/errors/moved_surface.h"

#include "compare/format/polydata.h"

#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

/// Largest distance from the points `from_m` (columns) to the triangles with corners `to_m`.
double one_way_m(const scene::Surface& surface, const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) {
  const vtkSmartPointer<vtkPolyData> target = polydata_of(to_m, surface.triangles);
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(target);
  locator->BuildLocator();

  vtkNew<vtkGenericCell> cell;
  double largest2 = 0.0;
  for (const auto& p : from_m.colwise()) {
    const double query[] = {p.x(), p.y(), p.z()};
    double closest[3], distance2 = 0.0;
    vtkIdType cell_id = 0;
    int sub_id = 0;
    locator->FindClosestPoint(query, closest, cell, cell_id, sub_id, distance2);
    largest2 = std::max(largest2, distance2);
  }
  return std::sqrt(largest2);
}

/// Sum of 2 A n over the triangles at each vertex, n the unit normal and A the area.
Eigen::Matrix3Xd triangle_normals_m2(const scene::Surface& surface, const Eigen::Matrix3Xd& place_m) {
  Eigen::Matrix3Xd sum_m2 = Eigen::Matrix3Xd::Zero(3, place_m.cols());
  for (const auto& [a, b, c] : surface.triangles) {
    const scene::Vec3 pa = place_m.col(a), pb = place_m.col(b), pc = place_m.col(c);
    const scene::Vec3 normal_m2 = (pb - pa).cross(pc - pa);
    for (const int corner : {a, b, c}) sum_m2.col(corner) += normal_m2;
  }
  return sum_m2;
}

}  // namespace

double enclosed_volume_m3(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m) {
  const Eigen::Matrix3Xd place_m = surface.points_m + displacement_m;
  double six_volumes = 0.0;
  for (const auto& [a, b, c] : surface.triangles) {
    const scene::Vec3 pa = place_m.col(a), pb = place_m.col(b), pc = place_m.col(c);
    six_volumes += pa.dot(pb.cross(pc));
  }
  return six_volumes / 6.0;
}

double hausdorff_m(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_a_m,
                   const Eigen::Matrix3Xd& displacement_b_m) {
  if (displacement_a_m == displacement_b_m) return 0.0;
  const Eigen::Matrix3Xd a_m = surface.points_m + displacement_a_m;
  const Eigen::Matrix3Xd b_m = surface.points_m + displacement_b_m;
  if (!a_m.allFinite() || !b_m.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return std::max(one_way_m(surface, a_m, b_m), one_way_m(surface, b_m, a_m));
}

Eigen::Matrix3Xd moved_normals(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m) {
  const Eigen::Matrix3Xd rest_m2 = triangle_normals_m2(surface, surface.points_m);
  Eigen::Matrix3Xd normals = triangle_normals_m2(surface, surface.points_m + displacement_m);
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    const scene::Vec3 rest = surface.normals.col(i);
    const bool crushed = normals.col(i).norm() == 0.0 || rest_m2.col(i).norm() == 0.0;
    normals.col(i) = crushed ? rest
                             : scene::Vec3(Eigen::Quaterniond::FromTwoVectors(rest_m2.col(i), rest) *
                                           scene::Vec3(normals.col(i)).normalized());
  }
  return normals;
}

Eigen::VectorXd angles_rad(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Eigen::VectorXd angles(a.cols());
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    const scene::Vec3 one = a.col(i), other = b.col(i);
    angles[i] = std::atan2(one.cross(other).norm(), one.dot(other));
  }
  return angles;
}

Eigen::VectorXd tool_gaps_m(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m,
                            const reference::ToolDistance& tool, const scene::Pose& pose) {
  Eigen::VectorXd gaps_m(surface.points_m.cols());
  for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
    const scene::Vec3 p_W_m = surface.points_m.col(i) + displacement_m.col(i);
    gaps_m[i] = tool.at(pose.orientation.conjugate() * (p_W_m - pose.position_m)).value_m;
  }
  return gaps_m;
}

}  // namespace touchstone::compare
