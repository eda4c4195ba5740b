// How the rest surface bends away from its tangent plane: what second-order cuts and depths of cells need.
#pragma once

#include "fast/contact/rest_distance.h"
#include "scene/shape/solids.h"

#include <cmath>

namespace touchstone::fast {

/// Curvature of the rest surface at the closest point of p_W_m along e_m times the square of the part of e_m that is
/// tangent [m]. Positive: the surface bends away from its outside.
[[nodiscard]] inline double bend_m(const scene::Box&, const scene::Vec3&, const RestDistance&,
                                   const scene::Vec3&) noexcept {
  return 0.0;
}
[[nodiscard]] inline double bend_m(const scene::Sphere& body, const scene::Vec3&, const RestDistance& rest,
                                   const scene::Vec3& e_m) noexcept {
  const double out_m = e_m.dot(rest.normal);
  return (e_m.squaredNorm() - out_m * out_m) / body.radius_m();
}
[[nodiscard]] inline double bend_m(const scene::Ellipsoid& body, const scene::Vec3&, const RestDistance& rest,
                                   const scene::Vec3& e_m) noexcept {
  // Of sum x_i^2 / a_i^2 = 1, whose gradient is 2 n / h with the support h.
  const scene::Vec3 tangent_m = e_m - e_m.dot(rest.normal) * rest.normal;
  return body.semi_axes_m().cwiseProduct(rest.normal).norm() *
         tangent_m.cwiseQuotient(body.semi_axes_m()).squaredNorm();
}
[[nodiscard]] inline double bend_m(const scene::Revolution& body, const scene::Vec3& p_W_m, const RestDistance& rest,
                                   const scene::Vec3& e_m) noexcept {
  const scene::Vec3 foot_m = p_W_m - rest.signed_distance_m * rest.normal - body.offset_m();
  const double r_m = std::sqrt(foot_m.x() * foot_m.x() + foot_m.y() * foot_m.y());
  if (!(r_m > 0.0)) return 0.0;
  const scene::Vec3 around(-foot_m.y() / r_m, foot_m.x() / r_m, 0.0);
  const double out = (foot_m.x() * rest.normal.x() + foot_m.y() * rest.normal.y()) / r_m;
  const double around_m = e_m.dot(around), along_m = e_m.dot(around.cross(rest.normal));
  double bend_m = out / r_m * around_m * around_m;
  for (int index = 0; index < body.piece_count(); ++index) {
    const scene::RevolutionPiece& piece = body.piece(index);
    if (!piece.straight() && foot_m.z() > piece.start_m.y() && foot_m.z() < piece.end_m.y())
      bend_m += along_m * along_m / piece.radius_m;
  }
  return bend_m;
}

/// Largest curvature of the rest surface.
[[nodiscard]] inline double most_curved_per_m(const scene::Box&) noexcept { return 0.0; }
[[nodiscard]] inline double most_curved_per_m(const scene::Sphere& body) noexcept { return 1.0 / body.radius_m(); }
[[nodiscard]] inline double most_curved_per_m(const scene::Ellipsoid& body) noexcept {
  const double least_m = body.semi_axes_m().minCoeff();
  return body.semi_axes_m().maxCoeff() / (least_m * least_m);
}
/// Not known: every cell is cut by its pieces.
[[nodiscard]] inline double most_curved_per_m(const scene::Revolution&) noexcept { return 0.0; }

}  // namespace touchstone::fast
