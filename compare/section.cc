#include "compare/section.h"

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

}  // namespace

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

std::vector<std::vector<EdgePoint>> cut_at_y(const scene::Surface& surface, double y_m) {
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

  // Chain by nearest end: patches do not share vertices, so the same place has several indices.
  const double same_place_m =
      1e-6 * (surface.points_m.rowwise().maxCoeff() - surface.points_m.rowwise().minCoeff()).norm();
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
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

}  // namespace touchstone::compare
