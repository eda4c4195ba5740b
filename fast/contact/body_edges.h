// The faces of a body that meet at an edge, for pieces of the tool's surface that are near to two of them.
#pragma once

#include "fast/contact/rest_distance.h"
#include "fast/contact/surface_cells.h"
#include "scene/shape/box.h"
#include "scene/shape/revolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace touchstone::fast {

/// A face as seen from a place.
struct NearFace {
  scene::Vec3 normal = scene::Vec3::Zero();                   ///< outward
  double above_m = -std::numeric_limits<double>::infinity();  ///< signed distance of the place, negative inside
};

/// Of a body of revolution the two faces that a place inside is nearest to, the nearest first.
inline std::array<NearFace, 2> nearest_faces(const scene::Revolution& body, const scene::Vec3& p_W) noexcept {
  const scene::Vec3 local = p_W - body.offset_m();
  const double r_m = std::sqrt(local.x() * local.x() + local.y() * local.y());
  const Eigen::Vector2d rz_m(r_m, local.z()), out(r_m > 0.0 ? local.x() / r_m : 1.0, r_m > 0.0 ? local.y() / r_m : 0.0);
  std::array<NearFace, 2> near;
  for (int index = 0; index < body.piece_count(); ++index) {
    const scene::RevolutionPiece& piece = body.piece(index);
    Eigen::Vector2d normal;
    double above_m;
    if (piece.straight()) {
      normal =
          Eigen::Vector2d(piece.end_m.y() - piece.start_m.y(), piece.start_m.x() - piece.end_m.x()) / piece.length_m;
      above_m = normal.dot(rz_m - piece.start_m);
    } else {
      normal = rz_m - piece.center_m;
      const double length_m = normal.norm();
      if (!(length_m > 0.0)) continue;
      normal /= length_m;
      above_m = length_m - piece.radius_m;
    }
    if (!(above_m > near[1].above_m)) continue;
    near[1] = {{normal.x() * out.x(), normal.x() * out.y(), normal.y()}, above_m};
    if (near[1].above_m > near[0].above_m) std::swap(near[0], near[1]);
  }
  return near;
}

/// Of a piece of surface near to the faces a and b: the share that is nearer to a, and what the place of both parts
/// adds to the height above a and takes from that above b. Heights vary evenly over the piece.
struct EdgeShare {
  double share, a_m, b_m;
};
/// @param by_m  how much the middle's height above a exceeds that above b
/// @param a_m, b_m  how the heights change along the two vectors of the spread
inline EdgeShare edge_share(double by_m, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) noexcept {
  const Eigen::Vector2d change_m = a_m - b_m;
  const double change2_m2 = change_m.squaredNorm(), half_m = std::sqrt(3.0 * change2_m2);
  if (!(half_m > std::abs(by_m))) return {by_m > 0.0 ? 1.0 : (by_m < 0.0 ? 0.0 : 0.5), 0.0, 0.0};
  const double moved_m = (half_m * half_m - by_m * by_m) / (4.0 * half_m * change2_m2);
  return {0.5 + 0.5 * by_m / half_m, moved_m * a_m.dot(change_m), moved_m * b_m.dot(change_m)};
}

/// Of a piece of surface, the mean depth below the closest points of the rest surface, and that of depth times normal.
struct MeanDepth {
  double depth_m;
  scene::Vec3 along_normals_m;
  explicit MeanDepth(const RestDistance& rest) noexcept
      : depth_m(-rest.signed_distance_m), along_normals_m(depth_m * rest.normal) {}
  MeanDepth(double mean_m, const scene::Vec3& along_m) noexcept : depth_m(mean_m), along_normals_m(along_m) {}
};

template <class Body>
MeanDepth mean_depth(const Body&, const scene::Mat3&, const scene::Vec3&, const RestDistance& rest,
                     const Spread&) noexcept {
  return MeanDepth(rest);
}

/// Of a piece that is nearer to one face in one part and to another in the rest.
inline MeanDepth mean_depth_at_edge(const scene::Box& box, const scene::Mat3& R_WT, const scene::Vec3& p_W,
                                    const RestDistance& rest, const Spread& spread_T_m) noexcept {
  const scene::Vec3 local = p_W - box.center_m(), above_m = local.cwiseAbs() - box.half_m();
  scene::Mat3 normal = scene::Mat3::Zero();
  for (int axis = 0; axis < 3; ++axis) normal(axis, axis) = std::copysign(1.0, local[axis]);
  const scene::Vec3 e1_m = normal * (R_WT * spread_T_m[0]), e2_m = normal * (R_WT * spread_T_m[1]);
  const auto pair = [&](int a, int b) {
    return edge_share(above_m[a] - above_m[b], {e1_m[a], e2_m[a]}, {e1_m[b], e2_m[b]});
  };
  const EdgeShare xy = pair(0, 1), yz = pair(1, 2), zx = pair(2, 0);
  scene::Vec3 share(xy.share * (1.0 - zx.share), yz.share * (1.0 - xy.share), zx.share * (1.0 - yz.share));
  const double sum = share.sum();
  if (!(sum > 0.0)) return MeanDepth(rest);
  share /= sum;
  scene::Vec3 depths_m = -share.cwiseProduct(above_m);
  depths_m += (1.0 - share.z()) * scene::Vec3(-xy.a_m, xy.b_m, 0.0) +
              (1.0 - share.x()) * scene::Vec3(0.0, -yz.a_m, yz.b_m) +
              (1.0 - share.y()) * scene::Vec3(zx.b_m, 0.0, -zx.a_m);
  depths_m = depths_m.cwiseMax(0.0);
  return {depths_m.sum(), normal * depths_m};
}

inline MeanDepth mean_depth(const scene::Box& box, const scene::Mat3& R_WT, const scene::Vec3& p_W,
                            const RestDistance& rest, const Spread& spread_T_m) noexcept {
  const auto above_m = [&](int axis) { return std::abs(p_W[axis] - box.center_m()[axis]) - box.half_m()[axis]; };
  const double ax_m = above_m(0), ay_m = above_m(1), az_m = above_m(2), most_m = std::max(std::max(ax_m, ay_m), az_m);
  const double x_m = most_m - ax_m, y_m = most_m - ay_m, z_m = most_m - az_m;
  // One of them is 0.
  const double second_m = (x_m + y_m) + z_m - std::max(std::max(x_m, y_m), z_m);
  if (second_m * second_m > 6.0 * (spread_T_m[0].squaredNorm() + spread_T_m[1].squaredNorm())) return MeanDepth(rest);
  return mean_depth_at_edge(box, R_WT, p_W, rest, spread_T_m);
}

inline MeanDepth mean_depth(const scene::Revolution& body, const scene::Mat3& R_WT, const scene::Vec3& p_W,
                            const RestDistance& rest, const Spread& spread_T_m) noexcept {
  const auto [a, b] = nearest_faces(body, p_W);
  const double by_m = a.above_m - b.above_m;
  // Two heights differ by more than they change over the piece, or there are not two faces and by_m is not finite.
  if (!(by_m * by_m <= 12.0 * (spread_T_m[0].squaredNorm() + spread_T_m[1].squaredNorm()))) return MeanDepth(rest);
  const scene::Vec3 e1_m = R_WT * spread_T_m[0], e2_m = R_WT * spread_T_m[1];
  const EdgeShare edge =
      edge_share(by_m, {a.normal.dot(e1_m), a.normal.dot(e2_m)}, {b.normal.dot(e1_m), b.normal.dot(e2_m)});
  const double a_m = std::max(0.0, -edge.share * a.above_m - edge.a_m),
               b_m = std::max(0.0, -(1.0 - edge.share) * b.above_m + edge.b_m);
  return {a_m + b_m, a_m * a.normal + b_m * b.normal};
}

}  // namespace touchstone::fast
