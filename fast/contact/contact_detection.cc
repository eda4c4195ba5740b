#include "fast/contact/contact_detection.h"

#include "fast/contact/body_edges.h"
#include "fast/contact/point_loops.h"
#include "fast/contact/rest_distance.h"
#include "scene/base/index.h"
#include "scene/shape/solids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <type_traits>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

template <class Body>
InsideSummary find_inside(const scene::Shape& shape, const ToolSamples& tool, const Placement& at, double margin_m,
                          int limit, RegionPoints& points) noexcept {
  const Body& body = static_cast<const Body&>(shape);
  points.spread = false;
  InsideSummary summary;
  int count = 0;
  const auto nodes = static_cast<std::int32_t>(tool.tree.size());
  for (std::int32_t node = 0; node < nodes && count < limit;) {
    const SampleBall& ball = nth(tool.tree, node);
    if (!may_touch(body, at.R_WT * ball.center_T_m + at.origin_W_m, ball.radius_m + margin_m)) {
      node = ball.next;
      continue;
    }
    ++node;
    if (!ball.leaf) continue;
    for (auto i = static_cast<std::size_t>(ball.begin); i < static_cast<std::size_t>(ball.end); ++i) {
      const Vec3 p_T(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]);
      const Vec3 p_W = at.R_WT * p_T + at.origin_W_m;
      if (surely_beyond(body, p_W, margin_m)) continue;
      const RestDistance rest = rest_distance(body, p_W);
      if (!(rest.signed_distance_m < margin_m)) continue;
      if (rest.signed_distance_m < 0.0) summary.add(rest.normal, -rest.signed_distance_m, tool.area_m2[i]);
      points.set(count++, FoundPoint{.p_W_m = p_W,
                                     .p_T_m = p_T,
                                     .normal_T = Vec3(tool.nx_T[i], tool.ny_T[i], tool.nz_T[i]),
                                     .area_m2 = tool.area_m2[i],
                                     .depth_m = -rest.signed_distance_m,
                                     .sample = static_cast<std::int32_t>(i)});
    }
  }
  points.count = count;
  return summary;
}

template <class Body>
InsideSummary summarise(const scene::Shape& shape, const RegionPoints& points) noexcept {
  const Body& body = static_cast<const Body&>(shape);
  InsideSummary summary;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const RestDistance rest = rest_distance(body, points.p_W_m(i));
    if (rest.signed_distance_m < 0.0) summary.add(rest.normal, -rest.signed_distance_m, points.area_m2[i]);
  }
  return summary;
}

/// Sets how the depths change along the two vectors of the points' spread. From the tool's surface, which they lie in,
/// d leads to the rest surface's tangent plane.
template <class Body, class WayOut>
void set_rises(const Body& body, const WayOut&, const Mat3& R_WT, const Vec3& d, RegionPoints& points) noexcept {
  set_rises(R_WT, d, points);
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    // The closest surface may be another side.
    if (-points.rest_normal_W(i).dot(d) > 0.5) continue;
    const Vec3 exit_W_m = points.p_W_m(i) - points.depth_m[i] * d;
    const Vec3 slope_T = depth_slope_T(R_WT, d, rest_distance(body, exit_W_m).normal, grazes_curved);
    const Spread spread_T_m = points.spread_T_m(i);
    points.rise1_m[i] = slope_T.dot(spread_T_m[0]);
    points.rise2_m[i] = slope_T.dot(spread_T_m[1]);
  }
}
template <>
void set_rises(const scene::Box&, const scene::BoxExit& way_out, const Mat3& R_WT, const Vec3& d,
               RegionPoints& points) noexcept {
  set_rises(way_out, R_WT, d, points);
}

template <class WayOut>
void set_rises(const scene::Revolution& body, const WayOut&, const Mat3& R_WT, const Vec3& d,
               RegionPoints& points) noexcept {
  const auto count = static_cast<std::size_t>(points.count);
  // Under a plane no piece leads to another face.
  bool plane = true;
  for (std::size_t i = 0; i < count && plane; ++i) plane = points.rest_normal_W(i).dot(d) < -1.0 + 1e-12;
  if (plane) return set_rises(R_WT, d, points);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [first, second] = nearest_faces(body, points.p_W_m(i) - points.depth_m[i] * d);
    const Spread spread_T_m = points.spread_T_m(i);
    const auto rise = [&](const NearFace& face) -> Rise {
      const Vec3 slope_T = depth_slope_T(R_WT, d, face.normal, grazes_plane);
      return {slope_T.dot(spread_T_m[0]), slope_T.dot(spread_T_m[1])};
    };
    const double against = second.normal.dot(d);
    const bool meets_second = against < -grazes_plane;
    const Rise here = rise(first);
    // Rounding may leave the place a little outside.
    set_over_edge(here, meets_second ? rise(second) : here,
                  meets_second ? std::max(0.0, second.above_m / against) : 0.0, points, i);
  }
}

template <class Body>
RegionExtent measure_depths(const scene::Shape& shape, const Mat3& R_WT, const Vec3& d, RegionPoints& points) noexcept {
  const Body& body = static_cast<const Body&>(shape);
  const auto way_out_m = exit_along(body, -d);
  keep_facing(R_WT.transpose() * d, points);
  set_depths(way_out_m, points);
  if (points.spread) set_rises(body, way_out_m, R_WT, d, points);
  RegionExtent extent;
  Vec3 center_sum = Vec3::Zero(), plain_sum = Vec3::Zero(), deepest_W_m = Vec3::Zero();
  const int kept = points.count;
  for (std::size_t k = 0; k < static_cast<std::size_t>(kept); ++k) {
    const Vec3 p_W = points.p_W_m(k);
    const double depth_m = points.depth_m[k], projected_m2 = points.area_m2[k] * points.cos_theta[k];
    const Vec3 on_surface_m = p_W - depth_m * d;
    if (k == 0 || depth_m > extent.deepest_m) {
      extent.deepest_m = depth_m;
      deepest_W_m = p_W;
    }
    extent.area_m2 += projected_m2;
    center_sum += projected_m2 * on_surface_m;
    plain_sum += on_surface_m;
  }
  if (kept > 0) extent.thickness_m = extent.deepest_m + exit_along(body, d)(deepest_W_m);
  // Samples that all stand on edge cover no area: each counts the same.
  if (extent.area_m2 > 0.0) {
    extent.center_W_m = center_sum / extent.area_m2;
  } else if (kept > 0) {
    extent.center_W_m = plain_sum / kept;
  }
  return extent;
}

template <class Body>
double exit_distance(const scene::Shape& shape, const Vec3& p_W_m, const Vec3& direction) noexcept {
  return exit_along(static_cast<const Body&>(shape), direction)(p_W_m);
}

}  // namespace

Detection detection_for(const scene::Shape& shape) noexcept {
  auto detection = scene::as_solid<Detection>(shape, []<class Body>() {
    return Detection{.find_inside = &find_inside<Body>,
                     .summarise = &summarise<Body>,
                     .measure_depths = &measure_depths<Body>,
                     .exit_distance_m = &exit_distance<Body>};
  });
  detection.find_cells = find_cells_for(shape);
  detection.pull_back = pull_back_for(shape);
  return detection;
}

Vec3 direction_from(const InsideSummary& inside, const Vec3& otherwise) noexcept {
  const double length = inside.normal_sum.norm();
  if (!(length > 1e-6 * inside.weight_sum)) return otherwise;
  return -inside.normal_sum / length;
}

Vec3 follow_direction(const Vec3& d, const InsideSummary& inside) noexcept {
  const double length = inside.normal_sum.norm();
  const bool normals_agree = length > 0.5 * inside.weight_sum;
  const bool same_side = -inside.normal_sum.dot(d) > 0.0;
  return normals_agree && same_side ? Vec3(-inside.normal_sum / length) : d;
}

}  // namespace touchstone::fast
