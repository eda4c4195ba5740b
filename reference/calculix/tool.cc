#include "reference/calculix/tool.h"

#include "reference/tool/tool_distance.h"
#include "scene/mesh/mesh_checks.h"
#include "scene/shape/surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace touchstone::reference {
namespace {

using scene::ToolShape;
using scene::Vec3;
using Vec2 = Eigen::Vector2d;

/// Longest side of a surface element.
double side_m(const ModelChoice& choice) {
  double side_m = 0.25 * choice.half_width_m;
  for (const ContactPatch& patch : choice.contacts) {
    for (const ContactPatch::Rim& rim : patch.rims) side_m = std::min(side_m, 0.5 * rim.bend_radius_m);
  }
  return side_m;
}

/// The point on the zero set of the distance that its gradient leads to.
Vec3 onto_surface_m(const ToolDistance& distance, Vec3 p_T_m) {
  for (int step = 0; step < 3; ++step) {
    const Gap<3> gap = distance.at(p_T_m);
    p_T_m -= gap.value_m * gap.gradient;
  }
  return p_T_m;
}

/// A disc of core_radius_m, its rim rounded by round_m, on a cylinder: the shape of sphere, capsule and cylinder as
/// seen from below.
struct Meridian {
  double core_radius_m, round_m, straight_m;  ///< straight_m: length of the cylinder's side
  double lowest_m;                            ///< over the mass centre
  [[nodiscard]] double arc_m() const { return 0.5 * std::numbers::pi * round_m; }
  /// Point at an arc length from the axis along the profile, moved inwards by inset_m.
  [[nodiscard]] Vec2 at(double s_m, double inset_m) const {
    if (s_m <= core_radius_m) return {s_m, lowest_m + inset_m};
    const double angle = std::min(s_m - core_radius_m, arc_m()) / round_m;
    const double beyond_m = std::max(0.0, s_m - core_radius_m - arc_m());
    return {core_radius_m + (round_m - inset_m) * std::sin(angle),
            lowest_m + round_m - (round_m - inset_m) * std::cos(angle) + beyond_m};
  }
};

Meridian meridian(const scene::Tool& tool, const Eigen::Quaterniond& orientation) {
  const double above_m = -(orientation * tool.mass_center_m.value_or(Vec3::Zero())).z();
  switch (tool.shape) {
    case ToolShape::sphere:
      return {0.0, tool.radius_m, 0.0, above_m - tool.radius_m};
    case ToolShape::capsule:
      return {0.0, tool.radius_m, tool.length_m, above_m - 0.5 * tool.length_m - tool.radius_m};
    default:
      return {tool.radius_m - tool.edge_radius_m, tool.edge_radius_m, tool.length_m - 2.0 * tool.edge_radius_m,
              above_m - 0.5 * tool.length_m};
  }
}

}  // namespace

ToolCoat<2> meridian_coat(const scene::Tool& tool, const Eigen::Quaterniond& orientation, const ModelChoice& choice) {
  const Meridian profile = meridian(tool, orientation);
  const double longest_m = side_m(choice), thickness_m = 0.25 * profile.round_m;
  // The profile is divided where its curvature jumps.
  std::vector<double> cuts_m{0.0};
  for (const double length_m : {profile.core_radius_m, profile.arc_m(), profile.straight_m}) {
    const int pieces = static_cast<int>(std::ceil(length_m / longest_m));
    const double begin_m = cuts_m.back();
    for (int piece = 1; piece <= pieces; ++piece) cuts_m.push_back(begin_m + length_m * piece / pieces);
  }
  // Per division, from outside inwards: corner, middle, corner; per piece the middles of its outer and its inner side.
  const int pieces = static_cast<int>(cuts_m.size()) - 1;
  ToolCoat<2> coat;
  coat.points_m.resize(2, 5 * pieces + 3);
  for (int cut = 0; cut <= pieces; ++cut) {
    for (int layer = 0; layer < 3; ++layer) {
      coat.points_m.col(5 * cut + layer) = profile.at(cuts_m[cut], 0.5 * layer * thickness_m);
    }
    if (cut == pieces) break;
    const double middle_m = 0.5 * (cuts_m[cut] + cuts_m[cut + 1]);
    coat.points_m.col(5 * cut + 3) = profile.at(middle_m, 0.0);
    coat.points_m.col(5 * cut + 4) = profile.at(middle_m, thickness_m);
    const int a = 5 * cut, b = a + 5;
    coat.elements.push_back({a, b, b + 2, a + 2, a + 3, b + 1, a + 4, a + 1});
  }
  return coat;
}

ToolCoat<3> surface_coat(const scene::Tool& tool, const ModelChoice& choice,
                         const std::function<bool(const Vec3& p_T_m)>& meets) {
  const bool flat = tool.shape == ToolShape::mesh;
  // The patches of a shape do not share the corners along their common edges.
  scene::RawMesh mesh;
  if (flat) {
    const scene::TriangleMesh given = scene::tool_mesh(tool);
    mesh.points.assign(given.points_m.colwise().begin(), given.points_m.colwise().end());
    mesh.triangles = given.triangles;
  } else {
    constexpr int fewest = 500, most = 200000;
    const auto shape = scene::tool_shape(tool);
    const double side = side_m(choice), triangle_m2 = 0.25 * std::sqrt(3.0) * side * side;
    const scene::Surface surface =
        scene::tessellate(*shape, std::clamp(static_cast<int>(shape->area_m2() / triangle_m2), fewest, most));
    mesh.points.assign(surface.points_m.colwise().begin(), surface.points_m.colwise().end());
    mesh.triangles = surface.triangles;
    mesh = scene::welded(mesh);
    for (Vec3& point_m : mesh.points) point_m = onto_surface_m(*choice.tool, point_m);
  }
  std::vector<char> near;
  for (const Vec3& point_m : mesh.points) near.push_back(meets(point_m));

  ToolCoat<3> coat;
  std::vector<Vec3> points_m;
  const auto add = [&](const Vec3& point_m) {
    points_m.push_back(point_m);
    return static_cast<int>(points_m.size()) - 1;
  };
  std::map<std::pair<int, int>, int> corners_and_middles;  // of the surface; neighbours share them
  const auto surface_node = [&](int v, int w) {
    const auto [place, fresh] = corners_and_middles.try_emplace(std::minmax(v, w), -1);
    if (fresh) {
      const Vec3 middle_m = 0.5 * (mesh.points[v] + mesh.points[w]);
      place->second = add(flat || v == w ? middle_m : onto_surface_m(*choice.tool, middle_m));
    }
    return place->second;
  };
  for (const auto& t : mesh.triangles) {
    if (!near[t[0]] && !near[t[1]] && !near[t[2]]) continue;
    const Vec3& corner_m = mesh.points[t[0]];
    const Vec3 across = (mesh.points[t[1]] - corner_m).cross(mesh.points[t[2]] - corner_m);
    // Every triangle has its own inner nodes, straight behind it, so that sharp edges of the tool are no problem.
    const Vec3 inward_m = -0.5 * across / std::sqrt(across.norm());
    std::array<int, ToolCoat<3>::nodes_per_element> element;
    for (int k = 0; k < 3; ++k) {
      element[3 + k] = surface_node(t[k], t[k]);
      element[9 + k] = surface_node(t[k], t[(k + 1) % 3]);
    }
    for (int k = 0; k < 3; ++k) {
      element[k] = add(points_m[element[3 + k]] + inward_m);
      element[6 + k] = add(points_m[element[9 + k]] + inward_m);
      element[12 + k] = add(points_m[element[3 + k]] + 0.5 * inward_m);
    }
    coat.elements.push_back(element);
  }
  coat.points_m = Eigen::Map<const Eigen::Matrix3Xd>(points_m.data()->data(), 3, points_m.size());
  return coat;
}

}  // namespace touchstone::reference
