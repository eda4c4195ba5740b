// The faces of a body that meet at an edge, for pieces of the tool's surface that are near to two of them.
#pragma once

#include "scene/shape/revolution.h"

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

}  // namespace touchstone::fast
