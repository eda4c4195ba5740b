#include "scene/shape/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

/// Unit vector along an axis, with a sign.
Vec3 axis_vector(int axis, double sign) noexcept {
  Vec3 e = Vec3::Zero();
  e[axis] = sign;
  return e;
}

}  // namespace

Box::Box(const Vec3& center_m, const Vec3& size_m) : center_m_(center_m), half_m_(0.5 * size_m) {}

SurfacePoint Box::at(int patch, double u, double v) const noexcept {
  const int axis = patch / 2;
  const double sign = patch % 2 == 0 ? -1.0 : 1.0;
  Vec3 local = sign * half_m_.cwiseProduct(axis_vector(axis, 1.0));
  // (u, v, outward normal) is right-handed on every face.
  const int first = (axis + (sign > 0 ? 1 : 2)) % 3;
  const int second = (axis + (sign > 0 ? 2 : 1)) % 3;
  local[first] = (2.0 * u - 1.0) * half_m_[first];
  local[second] = (2.0 * v - 1.0) * half_m_[second];
  return {center_m_ + local, axis_vector(axis, sign), 0.0, 0.0};
}

SurfaceQuery Box::query(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - center_m_;
  const Vec3 clamped = local.cwiseMax(-half_m_).cwiseMin(half_m_);
  const Vec3 beyond = local - clamped;
  const double outside_m = beyond.norm();
  // The face whose plane is highest above the point; inside it is the nearest face.
  const Vec3 above_face = local.cwiseAbs() - half_m_;
  int axis = 0;
  above_face.maxCoeff(&axis);
  const double sign = local[axis] < 0.0 ? -1.0 : 1.0;
  const int patch = 2 * axis + (sign > 0.0 ? 1 : 0);
  if (outside_m > 0.0) return {outside_m, center_m_ + clamped, beyond / outside_m, patch};
  Vec3 surface = local;
  surface[axis] = sign * half_m_[axis];
  return {above_face[axis], center_m_ + surface, axis_vector(axis, sign), patch};
}

double Box::signed_distance_m(const Vec3& p_m) const noexcept {
  const Vec3 above_face = (p_m - center_m_).cwiseAbs() - half_m_;
  return above_face.cwiseMax(0.0).norm() + std::min(above_face.maxCoeff(), 0.0);
}

double Box::area_m2() const noexcept {
  return 8.0 * (half_m_.x() * half_m_.y() + half_m_.y() * half_m_.z() + half_m_.z() * half_m_.x());
}

double Box::volume_m3() const noexcept { return 8.0 * half_m_.prod(); }

Bounds Box::bounds() const noexcept { return {center_m_ - half_m_, center_m_ + half_m_}; }

Sphere::Sphere(const Vec3& center_m, double radius_m) : center_m_(center_m), radius_m_(radius_m) {}

SurfacePoint Sphere::at(int patch, double u, double v) const noexcept {
  const double azimuth = 0.5 * std::numbers::pi * u;
  const double polar = 0.5 * std::numbers::pi * v;
  Vec3 normal(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
  for (int axis = 0; axis < 3; ++axis) {
    if (patch >> axis & 1) normal[axis] = -normal[axis];
  }
  return {center_m_ + radius_m_ * normal, normal, 1.0 / radius_m_, 1.0 / radius_m_};
}

SurfaceQuery Sphere::query(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - center_m_;
  const double distance_m = local.norm();
  // The centre is equally near to all: answer with the top.
  const Vec3 normal = distance_m > 0.0 ? Vec3(local / distance_m) : Vec3::UnitZ();
  const int patch = (normal.x() < 0.0 ? 1 : 0) | (normal.y() < 0.0 ? 2 : 0) | (normal.z() < 0.0 ? 4 : 0);
  return {distance_m - radius_m_, center_m_ + radius_m_ * normal, normal, patch};
}

double Sphere::signed_distance_m(const Vec3& p_m) const noexcept { return (p_m - center_m_).norm() - radius_m_; }

double Sphere::area_m2() const noexcept { return 4.0 * std::numbers::pi * radius_m_ * radius_m_; }

double Sphere::volume_m3() const noexcept { return 4.0 / 3.0 * std::numbers::pi * radius_m_ * radius_m_ * radius_m_; }

Bounds Sphere::bounds() const noexcept {
  return {center_m_ - Vec3::Constant(radius_m_), center_m_ + Vec3::Constant(radius_m_)};
}

}  // namespace touchstone::scene
