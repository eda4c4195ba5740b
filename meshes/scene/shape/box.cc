#include "scene/shape/box.h"

#include "scene/base/index.h"
#include "scene/shape/crossing.h"
#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::scene {
namespace {

/// Unit vector along an axis, with a sign.
Vec3 axis_vector(int axis, double sign) noexcept {
  Vec3 e = Vec3::Zero();
  e[axis] = sign;
  return e;
}

}  // namespace

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
  const Distance d = distance_at(p_m.x(), p_m.y(), p_m.z());
  if (outside_m > 0.0) return {outside_m, center_m_ + clamped, beyond / outside_m, patch_of(d)};
  const Vec3 normal(d.nx, d.ny, d.nz);
  const Vec3 surface = (normal.array() != 0.0).select(normal.cwiseProduct(half_m_), local);
  return {d.signed_distance_m, center_m_ + surface, normal, patch_of(d)};
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

Crossing Box::crossing(const Vec3& from_m, const Vec3& to_m) const noexcept {
  const Line line(from_m, to_m);
  double enter_m = 0.0, leave_m = line.length_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = from_m[axis] - center_m_[axis], half = half_m_[axis], step = line.direction[axis];
    if (step == 0.0) {
      if (std::abs(place) >= half) return {};
      continue;
    }
    const double low = (-half - place) / step, high = (half - place) / step;
    enter_m = std::max(enter_m, std::min(low, high));
    leave_m = std::min(leave_m, std::max(low, high));
  }
  return line.within(enter_m, leave_m);
}

Surface Box::tessellated(int triangles) const {
  // Square cells of one size h: 2 * area / h^2 triangles.
  const double h = std::sqrt(2.0 * area_m2() / triangles);
  const auto cells = [&](int axis) { return std::max(1, static_cast<int>(std::lround(2.0 * half_m_[axis] / h))); };
  SurfaceBuilder builder;
  for (int patch = 0; patch < patch_count(); ++patch) {
    builder.begin_patch();
    const int axis = patch / 2;
    const bool positive = patch % 2 == 1;
    const int nu = cells((axis + (positive ? 1 : 2)) % 3);
    const int nv = cells((axis + (positive ? 2 : 1)) % 3);
    std::vector<int> vertex;
    for (int j = 0; j <= nv; ++j) {
      for (int i = 0; i <= nu; ++i) {
        const SurfacePoint p = this->at(patch, static_cast<double>(i) / nu, static_cast<double>(j) / nv);
        vertex.push_back(builder.add_vertex(p.point_m, p.normal));
      }
    }
    const auto vertex_at = [&](int i, int j) { return nth(vertex, j * (nu + 1) + i); };
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        // Alternate the diagonal so that the pattern has no preferred direction.
        if ((i + j) % 2 == 0) {
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j), vertex_at(i + 1, j + 1));
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j + 1), vertex_at(i, j + 1));
        } else {
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j), vertex_at(i, j + 1));
          builder.add_triangle(vertex_at(i + 1, j), vertex_at(i + 1, j + 1), vertex_at(i, j + 1));
        }
      }
    }
  }
  return builder.finish();
}

}  // namespace touchstone::scene
