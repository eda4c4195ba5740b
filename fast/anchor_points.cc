#include "fast/anchor_points.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr int bottom_face = 4;

/// The two axes spanning a face of a box.
struct FaceAxes {
  int u, v;
};
FaceAxes face_axes(int patch) noexcept {
  const int axis = patch / 2;
  return {(axis + 1) % 3, (axis + 2) % 3};
}

}  // namespace

BoxAnchors::BoxAnchors(const scene::Box& box) : box_(box) {
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    points_m_.push_back(box.center_m() + sign.cwiseProduct(box.half_m()));
    held_.push_back((i & 4) == 0);
  }
  for (int patch = 0; patch < box.patch_count(); ++patch) {
    const int origin = patch % 2 == 1 ? 1 << patch / 2 : 0;
    const auto [u, v] = face_axes(patch);
    patches_.push_back({origin, origin | 1 << u, origin | 1 << v, origin | 1 << u | 1 << v});
  }
}

std::vector<int> BoxAnchors::around(int patch) const {
  const auto& corner = patches_[static_cast<std::size_t>(patch)];
  return {corner[0], corner[1], corner[3], corner[2]};
}

Vec3 BoxAnchors::halfway_m(int i, int j) const {
  // Two corners of one face: the straight line between them lies on it.
  return 0.5 * (points_m_[static_cast<std::size_t>(i)] + points_m_[static_cast<std::size_t>(j)]);
}

PatchPlace BoxAnchors::at(int patch, const Vec3& p_m) const noexcept {
  const auto axes = face_axes(patch);
  const Vec3 place = (p_m - box_.center_m()).cwiseQuotient(box_.half_m());
  const double u = std::clamp(0.5 * (place[axes.u] + 1.0), 0.0, 1.0);
  const double v = std::clamp(0.5 * (place[axes.v] + 1.0), 0.0, 1.0);
  PatchPlace at;
  at.weight = {(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v};
  if (patch != bottom_face) at.edge = {u, 1.0 - u, v, 1.0 - v};
  return at;
}

SphereAnchors::SphereAnchors(const scene::Sphere& sphere, double support_height_m)
    : sphere_(sphere), support_height_m_(support_height_m) {
  for (int i = 0; i < 6; ++i) {
    Vec3 out = Vec3::Zero();
    out[i / 2] = i % 2 == 0 ? sphere.radius_m() : -sphere.radius_m();
    points_m_.push_back(sphere.center_m() + out);
    // The lowest point is held even where the support has no height.
    held_.push_back(i == 5);
  }
  for (int patch = 0; patch < sphere.patch_count(); ++patch) {
    const int x = patch & 1 ? 1 : 0, y = patch & 2 ? 3 : 2, z = patch & 4 ? 5 : 4;
    patches_.push_back({x, y, z, x});
  }
}

std::vector<int> SphereAnchors::around(int patch) const {
  const auto& corner = patches_[static_cast<std::size_t>(patch)];
  return {corner[0], corner[1], corner[2]};
}

Vec3 SphereAnchors::halfway_m(int i, int j) const {
  const Vec3 between = points_m_[static_cast<std::size_t>(i)] + points_m_[static_cast<std::size_t>(j)];
  return sphere_.center_m() + sphere_.radius_m() * (between - 2.0 * sphere_.center_m()).normalized();
}

PatchPlace SphereAnchors::at(int patch, const Vec3& p_m) const noexcept {
  const Vec3 out = (p_m - sphere_.center_m()).cwiseAbs();
  const Vec3 barycentric = out / out.sum();
  PatchPlace at;
  if ((patch & 4) == 0) {
    at.weight = {barycentric.x(), barycentric.y(), barycentric.z(), 0.0};
    at.edge = {barycentric.x(), barycentric.y(), barycentric.z(), 1.0};
    return at;
  }
  const double height_m = p_m.z() - support_height_m_;
  const double equator_m = sphere_.center_m().z() - support_height_m_;
  const double ramp = std::clamp(height_m / equator_m, 0.0, 1.0);
  const double equator = barycentric.x() + barycentric.y();
  at.weight = {0.0, 0.0, 1.0, 0.0};
  if (ramp > 0.0 && equator > 0.0) {
    at.weight = {ramp * barycentric.x() / equator, ramp * barycentric.y() / equator, 1.0 - ramp, 0.0};
    // The patch's edges are its three sides and the support's circle.
    at.edge = {barycentric.x(), barycentric.y(), barycentric.z(), ramp};
  }
  return at;
}

std::unique_ptr<const AnchorPoints> anchor_points(const scene::Body& body, const scene::Shape& shape) {
  switch (body.shape) {
    case scene::BodyShape::box:
      return std::make_unique<BoxAnchors>(static_cast<const scene::Box&>(shape));
    case scene::BodyShape::sphere:
      return std::make_unique<SphereAnchors>(static_cast<const scene::Sphere&>(shape), body.support_height_m);
    default:
      break;
  }
  return nullptr;
}

}  // namespace touchstone::fast
