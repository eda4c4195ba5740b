// The depth of a tool below the rest surface, from the smallest signed distance of a convex body over the tool, and the
// first contact along a line, where that distance becomes zero.
#include "scene/model/rest_depth.h"

#include "scene/base/index.h"
#include "scene/base/least_value.h"
#include "scene/model/first_contact.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/BVH>

namespace touchstone::scene {
namespace {

/// @param enough as in least_value
double least_over_convex(const Shape& body, const Shape& tool, const Pose& pose, double tolerance_m, double enough) {
  const Bounds bounds = tool.bounds();
  const Eigen::Quaterniond into_tool = pose.orientation.conjugate();
  const Vec3 center_W_m = pose.orientation * Vec3(0.5 * (bounds.lower_m + bounds.upper_m)) + pose.position_m;
  const double radius_m = 0.5 * (bounds.upper_m - bounds.lower_m).norm();
  if (body.signed_distance_m(center_W_m) - radius_m >= enough) return enough;
  return least_value<3>(
      center_W_m, radius_m, tolerance_m, enough,
      [&](const Vec3& p_W_m) {
        const SurfaceQuery q = body.query(p_W_m);
        return Sample<3>{q.signed_distance_m, q.normal};
      },
      [&](const Vec3& p_W_m) {
        const SurfaceQuery q = tool.query(into_tool * (p_W_m - pose.position_m));
        return Reach<3>{q.signed_distance_m, pose.orientation * q.point_m + pose.position_m,
                        pose.orientation * q.normal};
      });
}

/// Along a segment the distance is convex: its slope changes sign once.
double least_over_segment(const Shape& body, const Vec3& from_m, const Vec3& to_m) {
  const Vec3 way_m = to_m - from_m;
  double low = 0.0, high = 1.0;
  double best = std::min(body.signed_distance_m(from_m), body.signed_distance_m(to_m));
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double middle = 0.5 * (low + high);
    const SurfaceQuery q = body.query(from_m + middle * way_m);
    best = std::min(best, q.signed_distance_m);
    (q.normal.dot(way_m) > 0.0 ? high : low) = middle;
  }
  return best;
}

/// Coordinates in the triangle's plane along two perpendicular directions.
double least_over_triangle(const Shape& body, const std::array<Vec3, 3>& corner_m, double tolerance_m) {
  using Vec2 = Eigen::Vector2d;
  const Vec3 x = (corner_m[1] - corner_m[0]).normalized();
  const Vec3 across = corner_m[2] - corner_m[0];
  const Vec3 y = (across - across.dot(x) * x).normalized();
  std::array<Vec2, 3> place;
  for (std::size_t k = 0; k < 3; ++k) {
    place[k] = Vec2((corner_m[k] - corner_m[0]).dot(x), (corner_m[k] - corner_m[0]).dot(y));
  }
  const Vec2 center = (place[0] + place[1] + place[2]) / 3.0;
  double radius_m = 0.0;
  for (const Vec2& p : place) radius_m = std::max(radius_m, (p - center).norm());
  return least_value<2>(
      center, radius_m, tolerance_m, INFINITY,
      [&](const Vec2& p) {
        const SurfaceQuery q = body.query(corner_m[0] + p.x() * x + p.y() * y);
        return Sample<2>{q.signed_distance_m, Vec2(q.normal.dot(x), q.normal.dot(y))};
      },
      [&](const Vec2& p) {
        Reach<2> reach{0.0, p, Vec2::Zero()};
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec2 edge = place[(k + 1) % 3] - place[k];
          const Vec2 out = Vec2(edge.y(), -edge.x()).normalized();
          const double off_m = (p - place[k]).dot(out);
          if (off_m <= reach.off_m) continue;
          reach.off_m = off_m;
          reach.normal = out;
          const double along = std::clamp((p - place[k]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
          reach.nearest = place[k] + along * edge;
        }
        return reach;
      });
}

/// Lower bound of the distance over a triangle, from the tangent planes at its corners.
double least_by_tangents_m(const std::array<Vec3, 3>& corner_m, const std::array<SurfaceQuery, 3>& at) {
  double bound_m = -INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    double falls_m = 0.0;
    for (const Vec3& p_m : corner_m) falls_m = std::min(falls_m, at[i].normal.dot(p_m - corner_m[i]));
    bound_m = std::max(bound_m, at[i].signed_distance_m + falls_m);
  }
  return bound_m;
}

/// Triangles whose lower bound by tangents is too large are skipped.
/// @param best  a value that need not be found if it is the minimum
double least_over_mesh(const Shape& body, const TriangleMesh& mesh, const Pose& pose, double tolerance_m, double best) {
  const Eigen::Matrix3Xd points_m = (pose.orientation.toRotationMatrix() * mesh.points_m).colwise() + pose.position_m;
  std::vector<SurfaceQuery> at(static_cast<std::size_t>(points_m.cols()));
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] = body.query(points_m.col(static_cast<Eigen::Index>(i)));
    best = std::min(best, at[i].signed_distance_m);
  }
  struct Candidate {
    double bound_m;
    std::array<std::int32_t, 3> triangle;
  };
  std::vector<Candidate> candidates;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 3> corner_m;
    std::array<SurfaceQuery, 3> at_corner;
    for (std::size_t k = 0; k < 3; ++k) {
      corner_m[k] = points_m.col(triangle[k]);
      at_corner[k] = nth(at, triangle[k]);
    }
    const double bound_m = least_by_tangents_m(corner_m, at_corner);
    if (bound_m < best - tolerance_m) candidates.push_back({bound_m, triangle});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.bound_m < b.bound_m; });
  for (const Candidate& candidate : candidates) {
    if (candidate.bound_m >= best - tolerance_m) break;
    const auto corner = [&](std::size_t k) { return Vec3(points_m.col(candidate.triangle[k])); };
    best = std::min(best, least_over_triangle(body, {corner(0), corner(1), corner(2)}, tolerance_m));
  }
  return best;
}

/// The triangles of a mesh in a tree of bounding boxes.
using Triangles = Eigen::KdBVH<double, 3, std::int32_t>;

/// Minimises the signed distance of a body over a mesh, in the form that Eigen::BVMinimize needs.
class LeastOverBoxes {
 public:
  using Scalar = double;
  /// @param best  a value that need not be found if it is the minimum
  LeastOverBoxes(const Shape& body, const TriangleMesh& mesh, const Pose& pose, double tolerance_m, double best)
      : body_(body),
        mesh_(mesh),
        turn_(pose.orientation.toRotationMatrix()),
        move_m_(pose.position_m),
        tolerance_m_(tolerance_m),
        best_(best) {}
  [[nodiscard]] double best() const noexcept { return best_; }

  /// The distance is convex, so in the box it lies above its tangent at the centre.
  double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
    const SurfaceQuery q = body_.query(turn_ * box.center() + move_m_);
    const double falls_m = 0.5 * (turn_.transpose() * q.normal).cwiseAbs().dot(box.sizes());
    const double bound_m = q.signed_distance_m - falls_m;
    return bound_m < best_ - tolerance_m_ ? bound_m : INFINITY;
  }
  double minimumOnObject(std::int32_t t) {
    std::array<Vec3, 3> corner_m;
    std::array<SurfaceQuery, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
      corner_m[k] = turn_ * mesh_.points_m.col(nth(mesh_.triangles, t)[k]) + move_m_;
      at[k] = body_.query(corner_m[k]);
      best_ = std::min(best_, at[k].signed_distance_m);
    }
    if (least_by_tangents_m(corner_m, at) < best_ - tolerance_m_)
      best_ = std::min(best_, least_over_triangle(body_, corner_m, tolerance_m_));
    return best_;
  }

 private:
  const Shape& body_;
  const TriangleMesh& mesh_;
  Eigen::Matrix3d turn_;
  Vec3 move_m_;
  double tolerance_m_, best_;
};

/// The smallest signed distance of the body over the tool [m]. @param enough  values not below it need not be exact
double least_distance_m(const Shape& body, const Tool& tool, const Pose& pose, double tolerance_m, double enough) {
  switch (tool.shape) {
    case ToolShape::sphere:
    case ToolShape::capsule: {
      // A ball's deepest point lies along the gradient at its centre.
      const Vec3 center_T_m = -tool.mass_center_m.value_or(Vec3::Zero());
      const Vec3 half_T_m(0.0, 0.0, tool.shape == ToolShape::capsule ? 0.5 * tool.length_m : 0.0);
      const auto to_world = [&](const Vec3& p_T_m) { return Vec3(pose.orientation * p_T_m + pose.position_m); };
      const double line_m = tool.shape == ToolShape::sphere ? body.signed_distance_m(to_world(center_T_m))
                                                            : least_over_segment(body, to_world(center_T_m - half_T_m),
                                                                                 to_world(center_T_m + half_T_m));
      return line_m - tool.radius_m;
    }
    case ToolShape::cylinder:
    case ToolShape::box:
      return least_over_convex(body, *tool_shape(tool), pose, tolerance_m, enough);
    case ToolShape::mesh:
      return least_over_mesh(body, tool_mesh(tool), pose, tolerance_m, enough);
  }
  return enough;
}

double diagonal_m(const Bounds& bounds) { return (bounds.upper_m - bounds.lower_m).norm(); }

/// Accuracy of depths and gaps.
double depth_tolerance_m(const Shape& body) { return 1e-8 * diagonal_m(body.bounds()); }

/// First zero of a convex function along a line; nothing if there is none before `end_m`. The extrapolated chord lies
/// below a convex function, so no zero is skipped.
/// @param function  Lipschitz with constant 1; known to tolerance_m
template <class Function>
std::optional<double> first_zero_m(double start_m, double end_m, double tolerance_m, const Function& function) {
  double before_m = start_m, before = function(before_m);
  if (before <= tolerance_m) return before_m;
  double here_m = before_m + before;
  for (int iteration = 0; iteration < 500 && here_m <= end_m; ++iteration) {
    const double here = function(here_m);
    if (here < -tolerance_m) {
      // Rounding led past the zero.
      for (int halving = 0; halving < 60; ++halving) {
        const double middle_m = 0.5 * (before_m + here_m);
        (function(middle_m) > 0.0 ? before_m : here_m) = middle_m;
      }
      return here_m;
    }
    if (here >= before) return here <= tolerance_m ? std::optional(here_m) : std::nullopt;
    const double chord_m = here * (here_m - before_m) / (before - here);
    if (here <= tolerance_m) return here_m + chord_m;
    before_m = here_m;
    before = here;
    here_m += std::max(here, chord_m);
  }
  return std::nullopt;
}

/// Distance that the mesh can move along the unit vector `direction` before it touches the body. @param points_m of the
/// mesh
std::optional<double> first_contact_of_mesh_m(const Shape& body, const TriangleMesh& mesh,
                                              const Eigen::Matrix3Xd& points_m, const Vec3& direction, double start_m,
                                              double end_m, double tolerance_m) {
  struct Candidate {
    double free_m;  ///< the triangle touches nothing within this distance
    std::array<std::int32_t, 3> triangle;
  };
  std::vector<Candidate> candidates(mesh.triangles.size());
  std::vector<SurfaceQuery> at(static_cast<std::size_t>(points_m.cols()));
  double moved_m = start_m;
  // Tangent planes of the body near the corners bound from below how far each triangle can move. Close to the body the
  // bounds are sharp enough to exclude nearly all triangles.
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = 0; i < at.size(); ++i)
      at[i] = body.query(points_m.col(static_cast<Eigen::Index>(i)) + moved_m * direction);
    double free_m = INFINITY;
    for (std::size_t t = 0; t < candidates.size(); ++t) {
      candidates[t] = {0.0, mesh.triangles[t]};
      for (const std::int32_t i : mesh.triangles[t]) {
        const SurfaceQuery& q = nth(at, i);
        double least_m = q.signed_distance_m;
        for (const std::int32_t j : mesh.triangles[t]) {
          least_m = std::min(least_m, q.signed_distance_m + q.normal.dot(points_m.col(j) - points_m.col(i)));
        }
        const double falls = -q.normal.dot(direction);
        if (least_m <= 0.0) continue;
        candidates[t].free_m = std::max(candidates[t].free_m, falls > 0.0 ? least_m / falls : INFINITY);
      }
      free_m = std::min(free_m, candidates[t].free_m);
    }
    if (moved_m + free_m > end_m) return std::nullopt;
    if (free_m < 1e-3 * (end_m - start_m)) break;
    moved_m += free_m;
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.free_m < b.free_m; });
  std::optional<double> first_m;
  for (const Candidate& candidate : candidates) {
    const double last_m = first_m.value_or(end_m);
    if (moved_m + candidate.free_m >= last_m - tolerance_m) break;
    const auto corner = [&](std::size_t k, double along_m) {
      return Vec3(points_m.col(candidate.triangle[k]) + along_m * direction);
    };
    const auto touch_m = first_zero_m(moved_m + candidate.free_m, last_m, 4.0 * tolerance_m, [&](double along_m) {
      return least_over_triangle(body, {corner(0, along_m), corner(1, along_m), corner(2, along_m)}, tolerance_m);
    });
    if (touch_m) first_m = touch_m;
  }
  return first_m;
}

}  // namespace

double rest_depth_m(const Shape& body, const Tool& tool, const Pose& pose) {
  return std::max(0.0, -least_distance_m(body, tool, pose, depth_tolerance_m(body), 0.0));
}

double gap_m(const Shape& body, const Tool& tool, const Pose& pose) {
  return least_distance_m(body, tool, pose, depth_tolerance_m(body), INFINITY);
}

struct RestDepth::MeshInBoxes {
  TriangleMesh mesh;
  Triangles triangles;
};

RestDepth::RestDepth(const Shape& body, const Tool& tool) : body_(body), tool_(tool) {
  if (tool.shape != ToolShape::mesh) return;
  TriangleMesh mesh = tool_mesh(tool);
  std::vector<std::int32_t> numbers;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& triangle : mesh.triangles) {
    numbers.push_back(static_cast<std::int32_t>(numbers.size()));
    Eigen::AlignedBox3d& box = boxes.emplace_back();
    for (const std::int32_t corner : triangle) box.extend(mesh.points_m.col(corner));
  }
  mesh_ = std::make_unique<const MeshInBoxes>(
      MeshInBoxes{std::move(mesh), Triangles(numbers.begin(), numbers.end(), boxes.begin(), boxes.end())});
}

RestDepth::~RestDepth() = default;

double RestDepth::depth_m(const Pose& pose) const { return std::max(0.0, -least_m(pose, 0.0)); }

double RestDepth::gap_m(const Pose& pose) const { return least_m(pose, INFINITY); }

double RestDepth::least_m(const Pose& pose, double enough) const {
  if (!mesh_) return least_distance_m(body_, tool_, pose, depth_tolerance_m(body_), enough);
  LeastOverBoxes least(body_, mesh_->mesh, pose, depth_tolerance_m(body_), enough);
  Eigen::BVMinimize(mesh_->triangles, least);
  return least.best();
}

std::optional<double> first_contact_m(const Shape& body, const Tool& tool, const Pose& pose, const Vec3& direction) {
  const Bounds bounds = body.bounds();
  const Vec3 unit = direction.normalized();
  Eigen::Matrix3Xd points_m;
  Vec3 center_W_m = pose.position_m;
  double radius_m = 0.0;
  std::optional<TriangleMesh> mesh;
  const std::unique_ptr<const Shape> shape = tool_shape(tool);
  if (shape) {
    const Bounds own = shape->bounds();
    center_W_m += pose.orientation * Vec3(0.5 * (own.lower_m + own.upper_m));
    radius_m = 0.5 * diagonal_m(own);
  } else {
    mesh = tool_mesh(tool);
    points_m = (pose.orientation.toRotationMatrix() * mesh->points_m).colwise() + pose.position_m;
    const Bounds own = mesh->bounds();
    center_W_m += pose.orientation * Vec3(0.5 * (own.lower_m + own.upper_m));
    radius_m = 0.5 * diagonal_m(own);
  }
  // From a place where both are certainly apart to the place where they are apart again.
  const double reach_m = radius_m + 0.5 * diagonal_m(bounds);
  const double middle_m = unit.dot(0.5 * (bounds.lower_m + bounds.upper_m) - center_W_m);
  const double start_m = middle_m - 1.01 * reach_m, end_m = middle_m + 1.01 * reach_m;
  const double tolerance_m = 1e-11 * diagonal_m(bounds);
  if (mesh) {
    return first_contact_of_mesh_m(body, *mesh, points_m, unit, start_m, end_m, tolerance_m);
  }
  const bool round = tool.shape == ToolShape::sphere || tool.shape == ToolShape::capsule;
  return first_zero_m(start_m, end_m, round ? 1e-14 : 4.0 * tolerance_m, [&](double along_m) {
    return least_distance_m(body, tool, {pose.position_m + along_m * unit, pose.orientation}, tolerance_m, INFINITY);
  });
}

}  // namespace touchstone::scene
