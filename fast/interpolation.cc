#include "fast/interpolation.h"

#include "fast/patch_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr std::size_t corners = corners_max;

/// Value of a quantity at p0 by the anchor points alone.
template <class Quantity>
Quantity at_p0(const std::array<Quantity, corners>& corner, const PatchPlace& place, Quantity sum) noexcept {
  for (std::size_t k = 0; k < corners; ++k) sum += place.weight[k] * corner[k];
  return sum;
}

bool moves(const ContactPoint& contact, std::size_t patch) noexcept {
  return static_cast<std::size_t>(contact.patch) == patch && contact.displacement_m.squaredNorm() > 0.0;
}

/// Angle of a displacement to the outward normal, `mean` standing in where nothing moves.
double displacement_angle(const Vec3& u_m, const Vec3& normal, const Vec3& mean_m) noexcept {
  return angle_to(u_m.squaredNorm() > 0.0 ? u_m : mean_m, normal);
}

/// A corner of a patch that moves.
struct MovingCorner {
  const float* weight;
  float x, y, z;
};

/// Sum of the displacements of a patch's moving corners by weight, all axes in one pass.
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
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    // Held corners are most of a body's, and a patch with three repeats one: what adds nothing is not read.
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
    if (!moves(contact, p)) continue;
    const Hat hat(rest, contact.place);
    const Eigen::Vector3f rise = (contact.displacement_m - at_p0(u, contact.place, Vec3(Vec3::Zero()))).cast<float>();
#pragma GCC ivdep
    for (std::size_t v = begin; v < end; ++v) {
      const float height = hat(v);
      x[v] += height * rise.x();
      y[v] += height * rise.y();
      z[v] += height * rise.z();
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
void interpolate_published(const SurfacePatches& rest, const std::vector<Vec3>& anchor_displacement_m,
                           const ContactPoint& contact, SurfaceField& field) noexcept {
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    const bool touched = moves(contact, p);
    Vec3 mean_m = touched ? contact.displacement_m : Vec3(Vec3::Zero());
    for (std::size_t k = 0; k < patch.corners; ++k) mean_m += u[k];

    std::array<double, corners> length{}, angle{};
    for (std::size_t k = 0; k < corners; ++k) {
      length[k] = u[k].norm();
      angle[k] = displacement_angle(u[k], patch.corner_normal[k], mean_m);
    }
    const Weighted length_at(rest, length), angle_at(rest, angle);
    // Without a contact point on this patch the hat has no height.
    const Hat hat(rest, contact.place);
    float length_rise = 0.0f, angle_rise = 0.0f;
    if (touched) {
      length_rise = static_cast<float>(contact.displacement_m.norm() - at_p0(length, contact.place, 0.0));
      angle_rise =
          static_cast<float>(angle_to(contact.displacement_m, contact.normal) - at_p0(angle, contact.place, 0.0));
    }
    const Eigen::Vector3f toward = mean_m.stableNormalized().cast<float>();
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
