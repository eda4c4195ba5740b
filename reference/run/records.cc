#include "reference/run/records.h"

#include "reference/contact/regions.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

namespace touchstone::reference {
namespace {

using scene::Scene;

/// The depth of each region: of the one, the tool's; of several, that of the mesh's triangles nearest to each.
std::vector<double> region_depths_m(const Scene& scene, const scene::Shape& body, const scene::Pose& pose,
                                    const std::vector<ContactRegion>& regions) {
  const scene::Tool& tool = scene.tool;
  if (regions.size() < 2 || tool.shape != scene::ToolShape::mesh) {
    return std::vector<double>(regions.size(), scene::rest_depth_m(body, tool, pose));
  }
  const scene::TriangleMesh mesh = scene::tool_mesh(tool);
  std::vector<std::vector<std::array<std::int32_t, 3>>> parts(regions.size());
  for (const auto& t : mesh.triangles) {
    const scene::Vec3 middle_T_m = (mesh.points_m.col(t[0]) + mesh.points_m.col(t[1]) + mesh.points_m.col(t[2])) / 3.0;
    const scene::Vec3 middle_m = pose.orientation * middle_T_m + pose.position_m;
    const auto nearest = std::min_element(regions.begin(), regions.end(), [&](const auto& a, const auto& b) {
      return (a.center_m - middle_m).squaredNorm() < (b.center_m - middle_m).squaredNorm();
    });
    parts[nearest - regions.begin()].push_back(t);
  }
  std::vector<double> depths_m;
  for (const auto& part : parts) {
    // Loose triangles, so that no vertex is without one.
    scene::TriangleMesh piece;
    piece.points_m.resize(3, 3 * static_cast<Eigen::Index>(part.size()));
    for (const auto& t : part) {
      const auto first = static_cast<std::int32_t>(3 * piece.triangles.size());
      for (int k = 0; k < 3; ++k) piece.points_m.col(first + k) = mesh.points_m.col(t[k]);
      piece.triangles.push_back({first, first + 1, first + 2});
    }
    scene::Tool one = tool;
    one.mesh = std::make_shared<scene::TriangleMesh>(std::move(piece));
    one.mass_center_m = scene::Vec3::Zero();
    depths_m.push_back(scene::rest_depth_m(body, one, pose));
  }
  return depths_m;
}

/// A region's centre moves no farther than the tool there, and a little.
/// @param before  the tool's place at the instant before, or nullptr
void add_regions(const Scene& scene, const scene::Shape& body, const std::vector<ContactRegion>& regions,
                 const scene::Pose* before, RegionIds& ids, scene::ReferenceInstant& record) {
  double reach_m = scene.contact.r_th_m;
  if (before) {
    double lever_m = 0.0;
    for (const ContactRegion& region : regions) {
      lever_m = std::max(lever_m, (region.center_m - record.tool.position_m).norm());
    }
    reach_m += (record.tool.position_m - before->position_m).norm() +
               lever_m * record.tool.orientation.angularDistance(before->orientation);
  }
  const std::vector<double> depths_m = region_depths_m(scene, body, record.tool, regions);
  for (const RegionIds::Place& place : ids.follow(regions, reach_m)) {
    const ContactRegion& region = regions[place.region];
    record.regions.push_back({depths_m[place.region], region.force_n, region.torque_nm, region.area_m2, place.id,
                              region.friction_n, scene.contact.friction && region.stuck_share == 0.0});
    record.region_middles_m.push_back(region.center_m);
  }
  // The tool may dip in between the nodes.
  if (regions.empty() && record.depth_m > 0.0) record.regions.push_back({.depth_m = record.depth_m});
}

}  // namespace

void fill_records(const Scene& scene, const std::vector<double>& times_s, const std::vector<Step>& steps,
                  const std::vector<Eigen::Matrix3Xd>& shapes, Result& result) {
  result.instants.clear();
  const std::unique_ptr<const scene::Shape> body = scene::body_shape(scene.body);
  int indefinite = 0;
  RegionIds ids;
  for (std::size_t instant = 0; instant < times_s.size(); ++instant) {
    const Observation& seen = steps[instant].seen;
    scene::ReferenceInstant record;
    record.time_s = times_s[instant];
    record.tool = scene::pose_at(scene.track, record.time_s);
    record.depth_m = scene::rest_depth_m(*body, scene.tool, record.tool);
    record.support_force_n = seen.support_force_n;
    record.displacement_m = shapes[instant];
    add_regions(scene, *body, seen.regions, instant > 0 ? &result.instants.back().tool : nullptr, ids, record);
    record.residual_penetration_m = seen.node_penetration_m;
    record.between_nodes_penetration_m = seen.between_nodes_penetration_m;
    record.equilibrium_rel = seen.equilibrium_rel;
    record.volume_change_rel = seen.volume_change_rel;
    result.instants.push_back(std::move(record));
    indefinite += steps[instant].indefinite;
  }
  if (indefinite > 0) {
    result.linear_solver += "; " + std::to_string(indefinite) + " tangents were not positive definite and were made so";
  }
}

}  // namespace touchstone::reference
