#include "compare/report/section.h"

#include <algorithm>
#include <array>
#include <limits>

namespace touchstone::compare {
namespace {

struct Segment {
  std::array<EdgePoint, 2> ends;
  bool used = false;
};

EdgePoint crossing(const scene::Surface& surface, Eigen::Index a, Eigen::Index b, double y_m) {
  const double ya = surface.points_m(1, a), yb = surface.points_m(1, b);
  return {a, b, (y_m - ya) / (yb - ya)};
}

bool is_behind(const scene::Surface& surface, Eigen::Index vertex, double y_m) {
  return surface.points_m(1, vertex) >= y_m;
}

/// Fine enough that the section of a sphere looks round.
constexpr int drawn_triangles = 8000;

/// Removes points that lie on the line between their neighbours.
std::vector<scene::Vec3> without_straight_points(const std::vector<scene::Vec3>& outline_m, double tolerance_m) {
  std::vector<scene::Vec3> kept_m;
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const scene::Vec3& before_m = kept_m.empty() ? outline_m.back() : kept_m.back();
    const scene::Vec3 onward_m = outline_m[(i + 1) % outline_m.size()] - before_m;
    const scene::Vec3 here_m = outline_m[i] - before_m;
    if (here_m.cross(onward_m).norm() > tolerance_m * onward_m.norm()) kept_m.push_back(outline_m[i]);
  }
  return kept_m;
}

Outlines outlines_m(const scene::Surface& surface, double y_m) {
  const double size_m = (surface.points_m.rowwise().maxCoeff() - surface.points_m.rowwise().minCoeff()).norm();
  Outlines found_m;
  for (const auto& outline : cut_at_y(surface, y_m)) {
    std::vector<scene::Vec3> places_m;
    for (const EdgePoint& p : outline) places_m.push_back(p.of(surface.points_m));
    found_m.push_back(without_straight_points(places_m, 1e-6 * size_m));
  }
  return found_m;
}

}  // namespace

double cut_y_m(const scene::Surface& surface, const scene::Pose& tool) {
  const double low_m = surface.points_m.row(1).minCoeff(), high_m = surface.points_m.row(1).maxCoeff();
  const double hair_m = 1e-7 * (high_m - low_m);
  return std::clamp(tool.position_m.y(), low_m + 2 * hair_m, high_m - 2 * hair_m) - hair_m;
}

Outlines tool_outlines_m(const scene::Tool& tool, const scene::Pose& pose, double y_m) {
  scene::Surface surface = scene::tool_surface(tool, drawn_triangles);
  surface.points_m = (pose.orientation.toRotationMatrix() * surface.points_m).colwise() + pose.position_m;
  return outlines_m(surface, y_m);
}

Outlines inclusion_outlines_m(const scene::Body& body, double y_m) {
  Outlines found_m;
  for (const scene::Inclusion& inclusion : body.inclusions) {
    const auto shape = scene::solid_shape(inclusion, inclusion.center_m);
    for (auto& outline_m : outlines_m(scene::tessellate(*shape, drawn_triangles), y_m)) {
      found_m.push_back(std::move(outline_m));
    }
  }
  return found_m;
}

std::vector<EdgePoint> triangle_behind_y(const scene::Surface& surface, std::size_t triangle, double y_m) {
  std::vector<EdgePoint> polygon;
  const auto& corners = surface.triangles[triangle];
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Index from = corners[i], to = corners[(i + 1) % 3];
    const bool from_behind = is_behind(surface, from, y_m), to_behind = is_behind(surface, to, y_m);
    if (from_behind) polygon.push_back({from, from, 0.0});
    if (from_behind != to_behind) polygon.push_back(crossing(surface, from, to, y_m));
  }
  return polygon;
}

std::vector<std::vector<EdgePoint>> cut_at_y(const scene::Surface& surface, double y_m, double gap_share) {
  if (surface.triangles.empty()) return {};
  const double same_place_m =
      gap_share * (surface.points_m.rowwise().maxCoeff() - surface.points_m.rowwise().minCoeff()).norm();
  std::vector<Segment> segments;
  for (const auto& corners : surface.triangles) {
    Segment segment;
    std::size_t found = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Index from = corners[i], to = corners[(i + 1) % 3];
      if (is_behind(surface, from, y_m) != is_behind(surface, to, y_m)) {
        segment.ends[found++] = crossing(surface, from, to, y_m);
      }
    }
    if (found == 2) segments.push_back(segment);
  }

  // Chains segments by the nearest end point: patches do not share vertices, so one place has several indices.
  std::vector<std::vector<EdgePoint>> outlines;
  for (Segment& first : segments) {
    if (first.used) continue;
    first.used = true;
    std::vector<EdgePoint> outline{first.ends[0], first.ends[1]};
    for (;;) {
      const scene::Vec3 tip_m = outline.back().of(surface.points_m);
      double nearest_m = std::numeric_limits<double>::infinity();
      Segment* next = nullptr;
      std::size_t near_end = 0;
      for (Segment& candidate : segments) {
        if (candidate.used) continue;
        for (std::size_t end = 0; end < 2; ++end) {
          const double distance_m = (candidate.ends[end].of(surface.points_m) - tip_m).norm();
          if (distance_m < nearest_m) {
            nearest_m = distance_m;
            next = &candidate;
            near_end = end;
          }
        }
      }
      if (next == nullptr || nearest_m > same_place_m) break;
      next->used = true;
      outline.push_back(next->ends[1 - near_end]);
    }
    if ((outline.front().of(surface.points_m) - outline.back().of(surface.points_m)).norm() <= same_place_m) {
      outline.pop_back();
    }
    // Where many triangles meet slightly off the plane, some segments are left over, all at one place.
    const scene::Vec3 first_m = outline.front().of(surface.points_m);
    const auto is_there = [&](const EdgePoint& p) { return (p.of(surface.points_m) - first_m).norm() <= same_place_m; };
    if (!std::all_of(outline.begin(), outline.end(), is_there)) outlines.push_back(std::move(outline));
  }
  return outlines;
}

}  // namespace touchstone::compare
