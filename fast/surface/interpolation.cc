#include "fast/surface/interpolation.h"

#include "fast/surface/patch_kernels.h"
#include "scene/base/index.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr std::size_t corners = corners_max;

/// Value of a quantity at p0, interpolated from the anchor points alone.
template <class Quantity>
Quantity at_p0(const std::array<Quantity, corners>& corner, const PatchPlace& place, Quantity sum) noexcept {
  for (std::size_t k = 0; k < corners; ++k) sum += place.weight[k] * corner[k];
  return sum;
}

const Patch& patch_of(const SurfacePatches& rest, const ContactPoint& contact) noexcept {
  return nth(rest.patches, contact.patch);
}

/// Whether the contact point's kernel function is not zero.
bool moves(const ContactPoint& contact) noexcept {
  return contact.displacement_m.squaredNorm() > 0.0 && !contact.place.held();
}

/// Lengths of the displacements at a patch's corners and their angles to the outward normal.
struct Printed {
  /// @param contact_m displacement of the contact point, as far as its kernel function extends over the patch
  Printed(const Patch& patch, const std::vector<Vec3>& anchor_displacement_m, const Vec3& contact_m) noexcept
      : mean_m(contact_m) {
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    for (std::size_t k = 0; k < patch.corners; ++k) mean_m += u[k];
    for (std::size_t k = 0; k < corners; ++k) {
      length_m[k] = u[k].norm();
      angle_rad[k] = angle_to(u[k].squaredNorm() > 0.0 ? u[k] : mean_m, patch.corner_normal[k]);
    }
  }
  std::array<double, corners> length_m, angle_rad;
  Vec3 mean_m;  ///< sum of the displacements; gives the direction where a corner does not move
};

/// A corner of a patch whose anchor point moves.
struct MovingCorner {
  const float* weight;
  float x, y, z;
};

/// Weighted sum of the displacements of a patch's moving corners, all axes in one pass.
template <std::size_t count>
TOUCHSTONE_INLINE void weigh(const MovingCorner* corner, std::size_t begin, std::size_t end, float* x, float* y,
                             float* z) noexcept {
  // Columns never overlap.
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    float sx = 0.0f, sy = 0.0f, sz = 0.0f;
    if constexpr (count > 0) {
      const float w0 = corner[0].weight[v];
      sx = w0 * corner[0].x, sy = w0 * corner[0].y, sz = w0 * corner[0].z;
    }
    if constexpr (count > 1) {
      const float w1 = corner[1].weight[v];
      sx += w1 * corner[1].x, sy += w1 * corner[1].y, sz += w1 * corner[1].z;
    }
    if constexpr (count > 2) {
      const float w2 = corner[2].weight[v];
      sx += w2 * corner[2].x, sy += w2 * corner[2].y, sz += w2 * corner[2].z;
    }
    if constexpr (count > 3) {
      const float w3 = corner[3].weight[v];
      sx += w3 * corner[3].x, sy += w3 * corner[3].y, sz += w3 * corner[3].z;
    }
    x[v] = sx, y[v] = sy, z[v] = sz;
  }
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void interpolate_corrected(const SurfacePatches& rest, const std::vector<Vec3>& anchor_displacement_m,
                           const ContactPoint& contact, SurfaceField& field) noexcept {
  float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
  const Patch& from = patch_of(rest, contact);
  const bool lifts = moves(contact);
  const Vec3 rise_m = contact.displacement_m -
                      at_p0(corner_displacements(from, anchor_displacement_m), contact.place, Vec3(Vec3::Zero()));
  for (const Patch& patch : rest.patches) {
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    // Most corners are fixed, and a patch with three corners repeats one: zero terms are skipped.
    MovingCorner moving[corners];
    std::size_t count = 0;
    for (std::size_t k = 0; k < patch.corners; ++k) {
      const Eigen::Vector3f to = u[k].cast<float>();
      if (!to.isZero(0.0f)) moving[count++] = {rest.weight[k].data(), to.x(), to.y(), to.z()};
    }
    switch (count) {
      case 0:
        weigh<0>(moving, begin, end, x, y, z);
        break;
      case 1:
        weigh<1>(moving, begin, end, x, y, z);
        break;
      case 2:
        weigh<2>(moving, begin, end, x, y, z);
        break;
      case 3:
        weigh<3>(moving, begin, end, x, y, z);
        break;
      default:
        weigh<4>(moving, begin, end, x, y, z);
    }
    if (!lifts) continue;
    const HatPart part = hat_part(from, contact.place, patch);
    if (part.reaches()) raise(rest, patch, part, rise_m, x, y, z);
  }
}

TOUCHSTONE_WIDE_LOOPS
void interpolate_published(const SurfacePatches& rest, const std::vector<Vec3>& anchor_displacement_m,
                           const ContactPoint& contact, SurfaceField& field) noexcept {
  const Patch& from = patch_of(rest, contact);
  const bool lifts = moves(contact);
  float length_rise = 0.0f, angle_rise = 0.0f;
  if (lifts) {
    const Printed at_from(from, anchor_displacement_m, contact.displacement_m);
    length_rise = static_cast<float>(contact.displacement_m.norm() - at_p0(at_from.length_m, contact.place, 0.0));
    angle_rise = static_cast<float>(angle_to(contact.displacement_m, contact.normal) -
                                    at_p0(at_from.angle_rad, contact.place, 0.0));
  }
  for (const Patch& patch : rest.patches) {
    const HatPart part = lifts ? hat_part_to_creases(from, contact.place, patch) : HatPart{};
    const Printed printed(patch, anchor_displacement_m, part.ceiling * contact.displacement_m);
    const Weighted length_at(rest, printed.length_m), angle_at(rest, printed.angle_rad);
    const Hat hat(rest, part);
    const Eigen::Vector3f toward = printed.mean_m.stableNormalized().cast<float>();
    const float *nx = rest.normal[0].data(), *ny = rest.normal[1].data(), *nz = rest.normal[2].data();
    float* x = field.displacement_m[0].data();
    float* y = field.displacement_m[1].data();
    float* z = field.displacement_m[2].data();
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    // Columns never overlap.
#pragma GCC ivdep
    for (std::size_t v = begin; v < end; ++v) {
      const float height = hat(v);
      const float raised_length = length_at(v) + height * length_rise, raised_angle = angle_at(v) + height * angle_rise;
      const Turned turned_m = turned(raised_length, raised_angle, toward, nx[v], ny[v], nz[v]);
      x[v] = turned_m.x;
      y[v] = turned_m.y;
      z[v] = turned_m.z;
    }
  }
}

}  // namespace touchstone::fast
