// Loops over one block of vertices, and the same at one point, for the shape of several contact regions.
#pragma once

#include "fast/surface/patch_kernels.h"
#include "fast/surface/shape_stack.h"
#include "scene/base/index.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace touchstone::fast {

using Lane = PassScratch::Lane;
using Lane3 = std::array<Lane, 3>;

/// As many numbers as a wide register holds.
using Several [[gnu::vector_size(32)]] = float;
inline constexpr std::size_t lanes_at_once = sizeof(Several) / sizeof(float);

/// Heights of the hats from `first` to `last` over one block of their patch.
TOUCHSTONE_INLINE void raise_hats(const SurfacePatches& rest, std::size_t first, std::size_t last, std::size_t p,
                                  const VertexBlock& block, ShapeStack& stack) noexcept {
  const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
  for (std::size_t k = first; k <= last; ++k) {
    if (!stack.hats.part(k, p).reaches()) continue;
    const Hat hat(rest, stack.hats.part(k, p));
    float* height = stack.scratch.height[k].data();
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) height[v] = hat(begin + v);
  }
}

/// The weights of the corners over one block.
TOUCHSTONE_INLINE void take_weights(const SurfacePatches& rest, const VertexBlock& block, ShapeStack& stack) noexcept {
  for (std::size_t k = 0; k < corners_max; ++k) {
    std::copy(rest.weight[k].begin() + block.begin, rest.weight[k].begin() + block.end,
              stack.scratch.corner_weight[k].begin());
  }
}

/// lane += by * other
TOUCHSTONE_INLINE void add(float by, const float* other, std::size_t count, Lane& lane) noexcept {
#pragma GCC ivdep
  for (std::size_t v = 0; v < count; ++v) lane[v] += by * other[v];
}

/// u_i over one block, its hats raised, and at one point, as printed.
struct Published {
  using Factor = FactorPublished;
  static constexpr auto factor = local_factor_published;
  static constexpr auto room = local_room_published;

  TOUCHSTONE_INLINE static void increment(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                                          std::size_t p, const VertexBlock& block, Lane3& out) noexcept {
    const ShapeStack::Printed& here = stack.printed[i * rest.patches.size() + p];
    const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
    Lane length, angle;
    const Weighted length_at(rest, here.length_m), angle_at(rest, here.angle_rad);
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) length[v] = length_at(begin + v);
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) angle[v] = angle_at(begin + v);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!stack.hats.part(k, p).reaches()) continue;
      const float* height = stack.scratch.height[k].data();
      add(static_cast<float>(stack.length_c_m[i * stack.hats.capacity() + k]), height, count, length);
      add(static_cast<float>(stack.angle_c_rad[i * stack.hats.capacity() + k]), height, count, angle);
    }
    const Eigen::Vector3f toward = here.toward.cast<float>();
    const float *nx = rest.normal[0].data() + begin, *ny = rest.normal[1].data() + begin;
    const float* nz = rest.normal[2].data() + begin;
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) {
      const Turned u = turned(length[v], angle[v], toward, nx[v], ny[v], nz[v]);
      out[0][v] = u.x;
      out[1][v] = u.y;
      out[2][v] = u.z;
    }
  }

  /// Sum of all u_i.
  TOUCHSTONE_INLINE static void whole(const SurfacePatches& rest, const ShapeStack& stack, std::size_t p,
                                      const VertexBlock& block, Lane3& out) noexcept {
    Lane3 u;
    out = {};
    for (std::size_t i = 0; i < stack.count(); ++i) {
      increment(rest, stack, i, p, block, u);
      for (std::size_t axis = 0; axis < 3; ++axis) add(1.0f, u[axis].data(), block_vertices, out[axis]);
    }
  }

  static scene::Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                                  const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    const ShapeStack::Printed& here = stack.printed[i * rest.patches.size() + p];
    double length_m = at_place(here.length_m, place), angle_rad = at_place(here.angle_rad, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!stack.hats.part(k, p).reaches()) continue;
      const double height = stack.hats.part(k, p).at(place);
      length_m += height * stack.length_c_m[i * stack.hats.capacity() + k];
      angle_rad += height * stack.angle_c_rad[i * stack.hats.capacity() + k];
    }
    const double magnitude_m = std::max(0.0, length_m), theta = std::clamp(angle_rad, 0.0, std::numbers::pi);
    const scene::Vec3 tangent = here.toward - here.toward.dot(at.normal) * at.normal;
    const double tangent2 = tangent.squaredNorm();
    const double to_unit = tangent2 > 1e-10 ? 1.0 / std::sqrt(tangent2) : 0.0;
    return magnitude_m * (std::cos(theta) * at.normal + std::sin(theta) * to_unit * tangent);
  }

  /// Sum of all u_i.
  static scene::Vec3 global_at(const SurfacePatches& rest, const ShapeStack& stack, const scene::SurfaceQuery& at,
                               const PatchPlace& place) noexcept {
    scene::Vec3 sum = scene::Vec3::Zero();
    for (std::size_t i = 0; i < stack.count(); ++i) sum += increment_at(rest, stack, i, at, place);
    return sum;
  }
};

/// The same as vectors.
struct Corrected {
  using Factor = FactorCorrected;
  static constexpr auto factor = local_factor_corrected;
  static constexpr auto room = local_room_corrected;

  TOUCHSTONE_INLINE static void increment(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                                          std::size_t p, const VertexBlock&, Lane3& out) noexcept {
    sum(rest, stack, stack.region[i].anchor_displacement_m, stack.vector_c_short_m.data() + i * stack.hats.capacity(),
        i + 1, p, out);
  }

  /// Sum of all u_i.
  TOUCHSTONE_INLINE static void whole(const SurfacePatches& rest, const ShapeStack& stack, std::size_t p,
                                      const VertexBlock&, Lane3& out) noexcept {
    sum(rest, stack, stack.anchor_total_m, stack.vector_total_short_m.data(), stack.count(), p, out);
  }

  /// W U and the first hats by their coefficients.
  TOUCHSTONE_INLINE static void sum(const SurfacePatches& rest, const ShapeStack& stack,
                                    std::span<const scene::Vec3> anchor_displacement_m, const Eigen::Vector3f* c_m,
                                    std::size_t hats, std::size_t p, Lane3& out) noexcept {
    const Patch& patch = rest.patches[p];
    std::array<Eigen::Vector3f, corners_max> corner;
    for (std::size_t k = 0; k < patch.corners; ++k) {
      corner[k] = nth(anchor_displacement_m, patch.anchor[k]).cast<float>();
    }
    // Whole lanes, their sums in registers; a lane's last places may be idle.
    for (std::size_t v = 0; v < block_vertices; v += lanes_at_once) {
      Several x{}, y{}, z{};
      const auto add_vector = [&](const Eigen::Vector3f& by_m, const Lane& share) __attribute__((always_inline)) {
        Several s;
        std::memcpy(&s, share.data() + v, sizeof s);
        x += s * by_m.x();
        y += s * by_m.y();
        z += s * by_m.z();
      };
      for (std::size_t k = 0; k < patch.corners; ++k) add_vector(corner[k], stack.scratch.corner_weight[k]);
      for (std::size_t k = 0; k < hats; ++k) {
        if (stack.hats.part(k, p).reaches()) add_vector(c_m[k], stack.scratch.height[k]);
      }
      std::memcpy(out[0].data() + v, &x, sizeof x);
      std::memcpy(out[1].data() + v, &y, sizeof y);
      std::memcpy(out[2].data() + v, &z, sizeof z);
    }
  }

  static scene::Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                                  const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    scene::Vec3 u_m = vector_at(rest, stack.region[i].anchor_displacement_m, p, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!stack.hats.part(k, p).reaches()) continue;
      u_m += stack.hats.part(k, p).at(place) * stack.vector_c_m[i * stack.hats.capacity() + k];
    }
    return u_m;
  }

  static scene::Vec3 global_at(const SurfacePatches& rest, const ShapeStack& stack, const scene::SurfaceQuery& at,
                               const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    scene::Vec3 u_m = vector_at(rest, stack.anchor_total_m, p, place);
    for (std::size_t k = 0; k < stack.count(); ++k) {
      if (stack.hats.part(k, p).reaches()) u_m += stack.hats.part(k, p).at(place) * stack.vector_total_m[k];
    }
    return u_m;
  }
};

/// Distances of the block's rest points to a point.
TOUCHSTONE_INLINE void distances_m(const SurfacePatches& rest, const VertexBlock& block, const Eigen::Vector3f& p_m,
                                   Lane& r_m) noexcept {
  const float *x = rest.rest_W_m[0].data() + block.begin, *y = rest.rest_W_m[1].data() + block.begin;
  const float* z = rest.rest_W_m[2].data() + block.begin;
  const float px = p_m.x(), py = p_m.y(), pz = p_m.z();
  const std::int32_t count = block.end - block.begin;
#pragma GCC ivdep
  for (std::int32_t v = 0; v < count; ++v) {
    const float dx = x[v] - px, dy = y[v] - py, dz = z[v] - pz;
    nth(r_m, v) = std::sqrt(dx * dx + dy * dy + dz * dz);
  }
}

/// Adds the sum of (w_i - 1) u_i over one block, i the near regions. The weights of its corners have been taken.
template <class Formulation>
TOUCHSTONE_INLINE void add_changes(const SurfacePatches& rest, float r_R_m, std::size_t p, const VertexBlock& block,
                                   ShapeStack& stack, Lane3& sum) noexcept {
  using Factor = typename Formulation::Factor;
  // What the hats and the contact points of the regions before this one are here.
  std::size_t known = 0;
  Lane r_m{}, change, room;
  room.fill(1.0f);
  Lane3 u{};
  for (const std::size_t i : stack.scratch.near) {
    const ShapeStack::Reach& own = stack.reach[i];
    if (block.distance2_m2(own.p0_W_m) >= r_R_m * r_R_m) continue;
    raise_hats(rest, known, i, p, block, stack);
    for (std::size_t k = known == 0 ? 0 : known - 1; k < i; ++k) {
      if (!stack.hats.takes_part(k)) continue;
      const ShapeStack::Reach& earlier = stack.reach[k];
      const float rim_m = earlier.terms.rim_m + earlier.terms.C_r_m;
      if (block.distance2_m2(earlier.p0_W_m) > rim_m * rim_m) continue;
      distances_m(rest, block, earlier.p0_W_m, r_m);
      const FactorTerms terms = earlier.terms;
      for (std::size_t v = 0; v < room.size(); ++v) room[v] *= Factor::room(terms, r_m[v]);
    }
    known = i + 1;
    distances_m(rest, block, own.p0_W_m, r_m);
    const FactorTerms terms = own.terms;
    for (std::size_t v = 0; v < change.size(); ++v) {
      const float inside = (Factor::at(terms, r_m[v]) - 1.0f) * room[v];
      change[v] = r_m[v] < r_R_m ? inside : 0.0f;
    }
    Formulation::increment(rest, stack, i, p, block, u);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t v = 0; v < change.size(); ++v) sum[axis][v] += change[v] * u[axis][v];
    }
  }
}

}  // namespace touchstone::fast
