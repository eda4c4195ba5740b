#include "fast/contact/separation.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace touchstone::fast {
namespace {

using scene::Pose;
using scene::Vec3;

// Oriented volumes: with others FCL copies both meshes in every query, or has no distance.
using Model = fcl::BVHModel<fcl::OBBRSSd>;

void build(const scene::Surface& surface, Model& model) {
  std::vector<fcl::Vector3d> points_m;
  std::vector<fcl::Triangle> triangles;
  for (int i = 0; i < surface.vertex_count(); ++i) points_m.emplace_back(surface.points_m.col(i));
  for (const auto& t : surface.triangles)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  model.beginModel(surface.triangle_count(), surface.vertex_count());
  model.addSubModel(points_m, triangles);
  if (model.endModel() == fcl::BVH_ERR_MODEL_OUT_OF_MEMORY) throw std::bad_alloc();
}

fcl::Transform3d transform(const Pose& pose) {
  fcl::Transform3d result = fcl::Transform3d::Identity();
  result.linear() = pose.orientation.normalized().toRotationMatrix();
  result.translation() = pose.position_m;
  return result;
}

}  // namespace

struct Separation::Hierarchies {
  const scene::Shape* body_shape;
  Model body, tool;
  Vec3 a_tool_point_T_m;
  double reach_m = 0.0;  ///< of the tool from its frame's origin
};

Separation::Separation(const scene::Shape& body, const scene::Surface& body_surface, const scene::Surface& tool)
    : hierarchies_(std::make_unique<Hierarchies>()) {
  hierarchies_->body_shape = &body;
  build(body_surface, hierarchies_->body);
  build(tool, hierarchies_->tool);
  hierarchies_->a_tool_point_T_m = tool.points_m.col(0);
  hierarchies_->reach_m = tool.points_m.colwise().norm().maxCoeff();
}

Separation::~Separation() = default;
Separation::Separation(Separation&&) noexcept = default;
Separation& Separation::operator=(Separation&&) noexcept = default;

bool Separation::touches(const Pose& pose) const {
  const fcl::Transform3d at = transform(pose);
  // For FCL a mesh is a surface: a tool inside the body touches nothing.
  if (hierarchies_->body_shape->signed_distance_m(at * hierarchies_->a_tool_point_T_m) < 0.0) return true;
  fcl::CollisionRequestd request;
  request.num_max_contacts = 1;
  request.enable_contact = false;
  fcl::CollisionResultd result;
  return fcl::collide(&hierarchies_->body, fcl::Transform3d::Identity(), &hierarchies_->tool, at, request, result) > 0;
}

double Separation::distance_m(const Pose& pose) const {
  if (touches(pose)) return 0.0;
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  const double distance_m = fcl::distance(&hierarchies_->body, fcl::Transform3d::Identity(), &hierarchies_->tool,
                                          transform(pose), request, result);
  return std::max(0.0, distance_m);
}

std::optional<double> Separation::first_contact_s(const std::vector<scene::Waypoint>& track, double tolerance_m) const {
  for (std::size_t k = 0; k + 1 < track.size(); ++k) {
    const scene::Waypoint &from = track[k], &to = track[k + 1];
    // No point of the tool travels further on this leg.
    const double way_m = (to.pose.position_m - from.pose.position_m).norm() +
                         from.pose.orientation.angularDistance(to.pose.orientation) * hierarchies_->reach_m;
    for (double part = 0.0; part < 1.0;) {
      const double time_s = from.time_s + part * (to.time_s - from.time_s);
      const double left_m = distance_m(scene::pose_at(track, time_s));
      if (left_m <= tolerance_m) return time_s;
      if (left_m >= (1.0 - part) * way_m) break;
      part += left_m / way_m;
    }
  }
  if (!track.empty() && distance_m(track.back().pose) <= tolerance_m) return track.back().time_s;
  return std::nullopt;
}

}  // namespace touchstone::fast
