// Boxes with edges along the axes.
#pragma once

#include "scene/shape/shape.h"

#include <cmath>

namespace touchstone::scene {

/// Distance from points inside a box along one direction to its surface.
class BoxExit {
 public:
  /// @param direction unit length
  BoxExit(const Vec3& center_m, const Vec3& half_m, const Vec3& direction) noexcept
      : center_m_(center_m), half_m_(half_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = std::abs(direction[axis]);
      // Never reached along an axis it does not move on.
      per_speed_[axis] = speed > 1e-300 ? 1.0 / speed : 1e300;
      sign_[axis] = std::copysign(1.0, direction[axis]);
    }
  }
  /// [m]; zero for a point on the surface or outside.
  [[nodiscard]] TOUCHSTONE_INLINE double operator()(double x_m, double y_m, double z_m) const noexcept {
    const Ways way = ways_m(x_m, y_m, z_m);
    const double first_m = way.x < way.y ? way.x : way.y, exit_m = first_m < way.z ? first_m : way.z;
    return exit_m > 0.0 ? exit_m : 0.0;
  }
  [[nodiscard]] double operator()(const Vec3& p_m) const noexcept { return (*this)(p_m.x(), p_m.y(), p_m.z()); }
  /// Outward normal of the face that is met.
  struct Face {
    double nx, ny, nz;
  };
  /// The face that is met, and the one that would be met next.
  struct TwoFaces {
    Face first, second;
    double between_m;  ///< way from the first one's plane to the second one's
  };
  [[nodiscard]] TOUCHSTONE_INLINE TwoFaces two_faces(double x_m, double y_m, double z_m) const noexcept {
    const Ways way = ways_m(x_m, y_m, z_m);
    const bool x = (way.x <= way.y) & (way.x <= way.z), y = !x & (way.y <= way.z), z = !(x | y);
    const bool x2 = !x & (y ? way.x <= way.z : way.x <= way.y), y2 = !y & !x2 & (x ? way.y <= way.z : true),
               z2 = !(x2 | y2);
    const double first_m = x ? way.x : (y ? way.y : way.z), second_m = x2 ? way.x : (y2 ? way.y : way.z);
    return {{x ? sign_.x() : 0.0, y ? sign_.y() : 0.0, z ? sign_.z() : 0.0},
            {x2 ? sign_.x() : 0.0, y2 ? sign_.y() : 0.0, z2 ? sign_.z() : 0.0},
            second_m - first_m};
  }

 private:
  /// To the planes of the three faces.
  struct Ways {
    double x, y, z;
  };
  [[nodiscard]] TOUCHSTONE_INLINE Ways ways_m(double x_m, double y_m, double z_m) const noexcept {
    return {(half_m_.x() - sign_.x() * (x_m - center_m_.x())) * per_speed_.x(),
            (half_m_.y() - sign_.y() * (y_m - center_m_.y())) * per_speed_.y(),
            (half_m_.z() - sign_.z() * (z_m - center_m_.z())) * per_speed_.z()};
  }
  Vec3 center_m_, half_m_, sign_, per_speed_;
};

/// Box with edges along the axes; patches 0..5 are the faces -x, +x, -y, +y, -z, +z.
class Box final : public Shape {
 public:
  /// @param size_m edge lengths, each > 0
  Box(const Vec3& center_m, const Vec3& size_m) : center_m_(center_m), half_m_(0.5 * size_m) {}
  [[nodiscard]] int patch_count() const noexcept override { return 6; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] Crossing crossing(const Vec3& from_m, const Vec3& to_m) const noexcept override;
  [[nodiscard]] int face_of(int patch) const noexcept override { return patch; }
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;
  [[nodiscard]] const Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const Vec3& half_m() const noexcept { return half_m_; }

  /// Of a point inside: from the face whose plane is highest above it. Outside only the sign of the distance is right.
  [[nodiscard]] TOUCHSTONE_INLINE Distance distance_at(double x_m, double y_m, double z_m) const noexcept {
    const double lx = x_m - center_m_.x(), ly = y_m - center_m_.y(), lz = z_m - center_m_.z();
    const double ax = std::abs(lx) - half_m_.x(), ay = std::abs(ly) - half_m_.y(), az = std::abs(lz) - half_m_.z();
    const double higher = ax > ay ? ax : ay;
    const bool x = (ax >= ay) & (ax >= az), y = !x & (ay >= az);
    return {higher > az ? higher : az, x ? std::copysign(1.0, lx) : 0.0, y ? std::copysign(1.0, ly) : 0.0,
            (x | y) ? 0.0 : std::copysign(1.0, lz)};
  }
  /// False only if the whole ball about p_m is outside.
  [[nodiscard]] bool may_touch(const Vec3& p_m, double radius_m) const noexcept {
    const Vec3 beyond_m = ((p_m - center_m_).cwiseAbs() - half_m_).cwiseMax(0.0);
    return beyond_m.squaredNorm() <= radius_m * radius_m;
  }
  /// query(), quicker for a point inside or straight over a face.
  [[nodiscard]] SurfaceQuery closest(const Vec3& p_m) const noexcept {
    const Vec3 above_face = (p_m - center_m_).cwiseAbs() - half_m_;
    if ((above_face.x() > 0.0) + (above_face.y() > 0.0) + (above_face.z() > 0.0) > 1) return query(p_m);
    const Distance d = distance_at(p_m.x(), p_m.y(), p_m.z());
    const bool low = d.nx + d.ny + d.nz < 0.0;
    const Vec3 face_m = center_m_ + (low ? Vec3(-half_m_) : half_m_);
    return {
        d.signed_distance_m,
        {d.nx != 0.0 ? face_m.x() : p_m.x(), d.ny != 0.0 ? face_m.y() : p_m.y(), d.nz != 0.0 ? face_m.z() : p_m.z()},
        {d.nx, d.ny, d.nz},
        patch_of(d)};
  }
  [[nodiscard]] BoxExit exit_along(const Vec3& direction) const noexcept { return {center_m_, half_m_, direction}; }

 private:
  [[nodiscard]] static int patch_of(const Distance& d) noexcept {
    return (d.nx != 0.0 ? 0 : d.ny != 0.0 ? 2 : 4) + (d.nx + d.ny + d.nz > 0.0 ? 1 : 0);
  }
  Vec3 center_m_, half_m_;
};

}  // namespace touchstone::scene
