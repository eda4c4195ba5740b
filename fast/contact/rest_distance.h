// The rest shape's exact distance, inlined per shape because contact detection asks it of every sample in every tick
// (section III). The same answers as scene::Shape gives, without the closest point.
#pragma once

#include "scene/shape/revolution.h"
#include "scene/shape/shape.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {

/// Signed distance [m] of a point of the world, negative inside, and its gradient for an inside point: the outward
/// normal of the rest surface at the closest point.
struct RestDistance {
  double signed_distance_m;
  scene::Vec3 normal;
};

/// @param p_m inside the box; outside only the sign of the distance is right
[[nodiscard]] inline RestDistance rest_distance(const scene::Box& box, const scene::Vec3& p_m) noexcept {
  const scene::Vec3 local = p_m - box.center_m();
  const scene::Vec3 above_face = local.cwiseAbs() - box.half_m();
  const bool x = above_face.x() >= above_face.y() && above_face.x() >= above_face.z();
  const bool y = !x && above_face.y() >= above_face.z();
  const bool z = !x && !y;
  return {above_face.maxCoeff(),
          scene::Vec3(x ? std::copysign(1.0, local.x()) : 0.0, y ? std::copysign(1.0, local.y()) : 0.0,
                      z ? std::copysign(1.0, local.z()) : 0.0)};
}

[[nodiscard]] inline RestDistance rest_distance(const scene::Sphere& sphere, const scene::Vec3& p_m) noexcept {
  const scene::Vec3 local = p_m - sphere.center_m();
  const double distance_m = local.norm();
  return {distance_m - sphere.radius_m(), distance_m > 0.0 ? scene::Vec3(local / distance_m) : scene::Vec3::UnitZ()};
}

/// The shape's own answer, found in a few steps from near the surface: the closest point is x_i = a_i q_i with
/// q_i(t) = a_i y_i / (t + a_i^2), where |q(t)| = 1, and t = 0 on the surface. 1 / |q| is concave and nearly straight;
/// Halley's method follows its curve.
[[nodiscard]] inline RestDistance rest_distance(const scene::Ellipsoid& ellipsoid, const scene::Vec3& p_m) noexcept {
  const scene::Vec3 local = p_m - ellipsoid.center_m();
  const scene::Vec3& a = ellipsoid.semi_axes_m();
  const scene::Vec3 a2 = a.cwiseProduct(a), ay = a.cwiseProduct(local);
  // Further in than this, towards the surface of points with two nearest sides, the shape's own way is the safe one.
  const double deepest = -0.9 * a2.minCoeff();
  double t = 0.0;
  for (int step = 0; step < 12; ++step) {
    const scene::Vec3 per = (a2 + scene::Vec3::Constant(t)).cwiseInverse(), q = ay.cwiseProduct(per);
    const scene::Vec3 q2 = q.cwiseProduct(q), q2_per = q2.cwiseProduct(per);
    const double length2 = q2.sum(), length = std::sqrt(length2), over = length - 1.0;
    if (std::abs(over) < 4e-16) break;
    const double s1 = q2_per.sum(), s2 = q2_per.dot(per);
    const double bent = 2.0 * s1 * s1 + 3.0 * over * (s1 * s1 - length2 * s2);
    // Far outside the curve leads astray; straight on is Newton's step.
    t += 2.0 * length2 * over * s1 / (bent > s1 * s1 ? bent : 2.0 * s1 * s1);
    if (!(t > deepest)) break;
    // The next step would change the last digit only.
    if (std::abs(over) < 1e-5) {
      const scene::Vec3 n = local.cwiseQuotient(a2 + scene::Vec3::Constant(t)).normalized();
      const scene::Vec3 an = a.cwiseProduct(n);
      return {local.dot(n) - an.norm(), n};
    }
  }
  const scene::SurfaceQuery closest = ellipsoid.query(p_m);
  return {closest.signed_distance_m, closest.normal};
}

[[nodiscard]] inline RestDistance rest_distance(const scene::Revolution& revolution, const scene::Vec3& p_m) noexcept {
  const scene::SurfaceQuery closest = revolution.query(p_m);
  return {closest.signed_distance_m, closest.normal};
}

/// False only if the whole ball about p_m is outside; of an ellipsoid, true for some of those, too.
template <class Body>
[[nodiscard]] bool may_touch(const Body& body, const scene::Vec3& p_m, double radius_m) noexcept {
  // Not "!(>)": a centre at NaN distance is outside.
  return body.signed_distance_m(p_m) <= radius_m;
}

[[nodiscard]] inline bool may_touch(const scene::Box& box, const scene::Vec3& p_m, double radius_m) noexcept {
  const scene::Vec3 beyond_m = ((p_m - box.center_m()).cwiseAbs() - box.half_m()).cwiseMax(0.0);
  return beyond_m.squaredNorm() <= radius_m * radius_m;
}

/// True only if the point is outside by more than margin_m: a cheap first question.
template <class Body>
[[nodiscard]] bool surely_beyond(const Body&, const scene::Vec3&, double) noexcept {
  return false;
}

/// Above 0 only if the whole ball about p_m is outside: the half-space that touches the ellipsoid and whose normal is
/// (x_i / a_i^2), which is nearly the nearest one. Without unit.
[[nodiscard]] inline double beyond_half_space(const scene::Ellipsoid& ellipsoid, const scene::Vec3& p_m,
                                              double radius_m) noexcept {
  const scene::Vec3 per_m = ellipsoid.semi_axes_m().cwiseInverse();
  const scene::Vec3 scaled = (p_m - ellipsoid.center_m()).cwiseProduct(per_m);
  const double ratio2 = scaled.squaredNorm();
  return ratio2 - std::sqrt(ratio2) - radius_m * scaled.cwiseProduct(per_m).norm();
}
[[nodiscard]] inline bool surely_beyond(const scene::Ellipsoid& ellipsoid, const scene::Vec3& p_m,
                                        double margin_m) noexcept {
  return beyond_half_space(ellipsoid, p_m, margin_m) > 0.0;
}
[[nodiscard]] inline bool may_touch(const scene::Ellipsoid& ellipsoid, const scene::Vec3& p_m,
                                    double radius_m) noexcept {
  // Not "!(>)": a centre at NaN distance is outside.
  return beyond_half_space(ellipsoid, p_m, radius_m) <= 0.0;
}

/// Way from inside points along one direction to the rest surface [m]; zero for a point on it or outside.
class BoxExit {
 public:
  /// @param direction unit length
  BoxExit(const scene::Box& box, const scene::Vec3& direction) noexcept : center_m_(box.center_m()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = std::abs(direction[axis]);
      // Never reached along an axis it does not move on.
      per_speed_[axis] = speed > 1e-300 ? 1.0 / speed : 1e300;
      sign_[axis] = std::copysign(1.0, direction[axis]);
      half_m_[axis] = box.half_m()[axis];
    }
  }
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const scene::Vec3 way_m = half_m_ - sign_.cwiseProduct(p_m - center_m_);
    const double exit_m = way_m.cwiseProduct(per_speed_).minCoeff();
    return exit_m > 0.0 ? exit_m : 0.0;
  }
  /// Of the face that the way leads to.
  [[nodiscard]] scene::Vec3 normal(const scene::Vec3& p_m) const noexcept {
    Eigen::Index axis = 0;
    (half_m_ - sign_.cwiseProduct(p_m - center_m_)).cwiseProduct(per_speed_).minCoeff(&axis);
    scene::Vec3 outward = scene::Vec3::Zero();
    outward[axis] = sign_[axis];
    return outward;
  }
  [[nodiscard]] const scene::Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const scene::Vec3& half_m() const noexcept { return half_m_; }
  [[nodiscard]] const scene::Vec3& sign() const noexcept { return sign_; }            ///< of the direction
  [[nodiscard]] const scene::Vec3& per_speed() const noexcept { return per_speed_; }  ///< 1 / abs(direction)

 private:
  scene::Vec3 center_m_, half_m_, sign_, per_speed_;
};

class SphereExit {
 public:
  /// @param direction unit length
  SphereExit(const scene::Sphere& sphere, const scene::Vec3& direction) noexcept
      : center_m_(sphere.center_m()), direction_(direction), radius2_m2_(sphere.radius_m() * sphere.radius_m()) {}
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const scene::Vec3 local = p_m - center_m_;
    const double along_m = local.dot(direction_);
    const double inside_m2 = radius2_m2_ - local.squaredNorm();
    if (!(inside_m2 > 0.0)) return 0.0;
    return std::sqrt(along_m * along_m + inside_m2) - along_m;
  }
  [[nodiscard]] const scene::Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const scene::Vec3& direction() const noexcept { return direction_; }
  [[nodiscard]] double radius2_m2() const noexcept { return radius2_m2_; }

 private:
  scene::Vec3 center_m_, direction_;
  double radius2_m2_;
};

class EllipsoidExit {
 public:
  /// @param direction unit length
  EllipsoidExit(const scene::Ellipsoid& ellipsoid, const scene::Vec3& direction) noexcept
      : center_m_(ellipsoid.center_m()),
        per_axis_(ellipsoid.semi_axes_m().cwiseInverse()),
        direction_(direction.cwiseProduct(per_axis_)),
        a_(direction_.squaredNorm()) {}
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    // |s + t e| = 1 with both divided by the semi-axes.
    const scene::Vec3 local = (p_m - center_m_).cwiseProduct(per_axis_);
    const double inside = 1.0 - local.squaredNorm();
    if (!(inside > 0.0)) return 0.0;
    const double along = local.dot(direction_);
    const double root = std::sqrt(along * along + a_ * inside);
    return along > 0.0 ? inside / (root + along) : (root - along) / a_;
  }
  [[nodiscard]] const scene::Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const scene::Vec3& per_axis() const noexcept { return per_axis_; }    ///< 1 / semi-axes
  [[nodiscard]] const scene::Vec3& direction() const noexcept { return direction_; }  ///< times that
  [[nodiscard]] double a() const noexcept { return a_; }                              ///< its length squared

 private:
  scene::Vec3 center_m_, per_axis_, direction_;
  double a_;
};

/// For any convex shape, by Newton's method on its signed distance. Along a line that is convex: whatever the first
/// step from inside, it ends on the surface or beyond, and from there the steps come back without passing the surface.
template <class Body>
class ConvexExit {
 public:
  /// @param direction unit length
  ConvexExit(const Body& body, const scene::Vec3& direction) noexcept
      : body_(body),
        direction_(direction),
        around_(0.5 * (body.bounds().lower_m + body.bounds().upper_m), body.bounds().upper_m - body.bounds().lower_m),
        bounds_(around_, direction),
        tolerance_m_(1e-13 * 2.0 * around_.half_m().maxCoeff()) {}
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const RestDistance start = rest_distance(body_, p_m);
    if (!(start.signed_distance_m < 0.0)) return 0.0;
    const double farthest_m = bounds_(p_m), slope = start.normal.dot(direction_);
    // The distance cannot be shorter than the signed one, and a first step that hardly climbs would go too far.
    double way_m = -start.signed_distance_m < slope * farthest_m ? -start.signed_distance_m / slope : farthest_m;
    for (int step = 0; step < most_steps; ++step) {
      const RestDistance here = rest_distance(body_, p_m + way_m * direction_);
      const double climb = here.normal.dot(direction_);
      if (!(here.signed_distance_m > tolerance_m_) || !(climb > 0.0)) break;
      way_m -= here.signed_distance_m / climb;
    }
    return std::max(way_m, -start.signed_distance_m);
  }

 private:
  static constexpr int most_steps = 60;
  const Body& body_;
  scene::Vec3 direction_;
  scene::Box around_;
  BoxExit bounds_;
  double tolerance_m_;
};

/// Pieces of the profile that sweep out cones, planes or spheres are met in closed form. A line from inside a convex
/// body leaves it once, so a meeting that lies on its piece is the exit; the piece of the last exit is tried first.
class RevolutionExit {
 public:
  /// @param direction unit length
  RevolutionExit(const scene::Revolution& revolution, const scene::Vec3& direction) noexcept
      : revolution_(revolution), direction_(direction), any_(revolution, direction) {}
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const scene::Vec3 local = p_m - revolution_.offset_m();
    const double r = std::sqrt(local.x() * local.x() + local.y() * local.y());
    const int pieces = revolution_.piece_count();
    for (int k = 0; k < pieces; ++k) {
      const int index = last_ + k < pieces ? last_ + k : last_ + k - pieces;
      const double way_m = meeting_m(revolution_.piece(index), local, r);
      if (!(way_m > 0.0)) continue;
      last_ = index;
      return way_m;
    }
    return any_(p_m);
  }

 private:
  /// Way to a piece from a point beneath it; not above 0 where it is not met, or not for sure.
  [[nodiscard]] double meeting_m(const scene::RevolutionPiece& piece, const scene::Vec3& local,
                                 double r) const noexcept {
    double way_m;
    if (!piece.straight() && piece.center_m.x() != 0.0) {
      way_m = ring_meeting_m(piece, local);
    } else if (!piece.straight()) {
      const scene::Vec3 from_center = local - scene::Vec3(0.0, 0.0, piece.center_m.y());
      const double inside_m2 = piece.radius_m * piece.radius_m - from_center.squaredNorm();
      if (!(inside_m2 > 0.0)) return -1.0;
      const double along_m = from_center.dot(direction_);
      const double root_m = std::sqrt(along_m * along_m + inside_m2);
      way_m = along_m > 0.0 ? inside_m2 / (root_m + along_m) : root_m - along_m;
    } else if (piece.start_m.y() == piece.end_m.y()) {
      way_m = (piece.start_m.y() - local.z()) / direction_.z();
      const double x = local.x() + way_m * direction_.x(), y = local.y() + way_m * direction_.y();
      const double rim_m = std::max(piece.start_m.x(), piece.end_m.x()),
                   hole_m = std::min(piece.start_m.x(), piece.end_m.x()), r2_m2 = x * x + y * y;
      return r2_m2 <= rim_m * rim_m && r2_m2 >= hole_m * hole_m ? way_m : -1.0;
    } else {
      // n_r r + n_z z = c with the normal (n_r, n_z), squared where it holds r.
      const Eigen::Vector2d along = (piece.end_m - piece.start_m) / piece.length_m;
      const double nr = along.y(), nz = -along.x();
      if (nr < 1e-3) return -1.0;  // so flat that the squares would cost digits
      const double w = nr * piece.start_m.x() + nz * (piece.start_m.y() - local.z());
      const double out_m2 = (nr * r - w) * (nr * r + w);
      if (!(out_m2 < 0.0)) return -1.0;
      const double dx = direction_.x(), dy = direction_.y(), dz = direction_.z();
      const double A = nr * nr * (dx * dx + dy * dy) - nz * nz * dz * dz;
      const double B = nr * nr * (local.x() * dx + local.y() * dy) + nz * dz * w;
      const double D = B * B - A * out_m2;
      if (!(D >= 0.0) || (A <= 0.0 && B <= 0.0)) return -1.0;
      way_m = B > 0.0 ? -out_m2 / (B + std::sqrt(D)) : (std::sqrt(D) - B) / A;
    }
    const double z = local.z() + way_m * direction_.z();
    return z >= piece.start_m.y() && z <= piece.end_m.y() ? way_m : -1.0;
  }

  /// The same for an arc off the axis: Newton's method on the distance to its circle, which is convex along the line
  /// where r is beyond the circle's centre.
  [[nodiscard]] double ring_meeting_m(const scene::RevolutionPiece& piece, const scene::Vec3& local) const noexcept {
    double way_m = 0.0;
    for (int step = 0; step < 20; ++step) {
      const scene::Vec3 p_m = local + way_m * direction_;
      const double r = std::sqrt(p_m.x() * p_m.x() + p_m.y() * p_m.y());
      const double beyond_m = r - piece.center_m.x(), above_m = p_m.z() - piece.center_m.y();
      const double length_m = std::sqrt(beyond_m * beyond_m + above_m * above_m);
      if (!(beyond_m > 0.0)) return -1.0;
      const double climb =
          (beyond_m * (p_m.x() * direction_.x() + p_m.y() * direction_.y()) / r + above_m * direction_.z()) / length_m;
      const double over_m = length_m - piece.radius_m;
      if (!(climb > 0.0) || !(over_m < 0.5 * piece.radius_m)) return -1.0;
      way_m -= over_m / climb;
      if (std::abs(over_m) < 1e-9 * piece.radius_m) return way_m;
    }
    return -1.0;
  }

  const scene::Revolution& revolution_;
  scene::Vec3 direction_;
  ConvexExit<scene::Revolution> any_;
  mutable int last_ = 0;
};

[[nodiscard]] inline BoxExit exit_along(const scene::Box& box, const scene::Vec3& direction) noexcept {
  return {box, direction};
}
[[nodiscard]] inline SphereExit exit_along(const scene::Sphere& sphere, const scene::Vec3& direction) noexcept {
  return {sphere, direction};
}

[[nodiscard]] inline EllipsoidExit exit_along(const scene::Ellipsoid& ellipsoid,
                                              const scene::Vec3& direction) noexcept {
  return {ellipsoid, direction};
}
[[nodiscard]] inline RevolutionExit exit_along(const scene::Revolution& revolution,
                                               const scene::Vec3& direction) noexcept {
  return {revolution, direction};
}

}  // namespace touchstone::fast
