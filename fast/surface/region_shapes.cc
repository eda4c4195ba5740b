#include "fast/surface/region_shapes.h"

#include "fast/surface/local_factor_kernel.h"
#include "fast/surface/patch_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Least part of a hat that must be a region's own. Two regions a part s of the patch apart leave about 4 s.
constexpr double pivot_min = 1.0 / 32.0;

using Lane = ShapeStack::Lane;
using Lane3 = std::array<Lane, 3>;

/// As many numbers as a wide register holds.
using Several [[gnu::vector_size(32)]] = float;
constexpr std::size_t lanes_at_once = sizeof(Several) / sizeof(float);

bool takes_part(const ShapeStack& stack, std::size_t k) noexcept { return stack.takes_part[k] != 0; }

/// What hat h_k is on a patch.
const HatPart& hat_of(const ShapeStack& stack, std::size_t k, std::size_t patch) noexcept {
  return stack.hat[k * stack.patches + patch];
}

/// h_k(p0_j)
double hat_at_contact(const ShapeStack& stack, std::size_t k, std::size_t j) noexcept {
  const ContactPoint& at = stack.region[j].contact;
  return takes_part(stack, j) ? hat_of(stack, k, static_cast<std::size_t>(at.patch)).at(at.place) : 0.0;
}

double at_place(const std::array<double, corners_max>& corner, const PatchPlace& place) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners_max; ++k) sum += place.weight[k] * corner[k];
  return sum;
}

/// W(p) U for the anchor points' displacements.
template <class Displacements>
Vec3 vector_at(const SurfacePatches& rest, const Displacements& anchor_m, std::size_t patch,
               const PatchPlace& place) noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < corners_max; ++k) {
    sum += place.weight[k] * anchor_m[static_cast<std::size_t>(rest.patches[patch].anchor[k])];
  }
  return sum;
}

/// Lays the region on the stack and lets the factorisation grow by its row and column.
template <class Factor>
void grow(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
          decltype(hat_part)* part_of, ShapeStack& stack) noexcept {
  const std::size_t i = stack.count++, n = stack.capacity;
  stack.region[i] = region;
  stack.takes_part[i] = region.contact.displacement_m.squaredNorm() > 0.0 && !region.contact.place.held() ? 1 : 0;
  const Patch& from = rest.patches[static_cast<std::size_t>(region.contact.patch)];
  for (std::size_t p = 0; p < stack.patches; ++p) {
    stack.hat[i * stack.patches + p] =
        takes_part(stack, i) ? part_of(from, region.contact.place, rest.patches[p]) : HatPart{};
  }
  if (local != nullptr) stack.reach[i] = {Factor::terms(*local, region.size), region.p0_W_m.cast<float>()};
  std::vector<double>& a = stack.factor;
  for (std::size_t k = 0; k < i; ++k) {
    double below = hat_at_contact(stack, k, i), above = hat_at_contact(stack, i, k);
    for (std::size_t m = 0; m < k; ++m) {
      below -= a[i * n + m] * a[m * n + k];
      above -= a[k * n + m] * a[m * n + i];
    }
    a[i * n + k] = below / a[k * n + k];
    a[k * n + i] = above;
  }
  double pivot = 1.0;
  for (std::size_t m = 0; m < i; ++m) pivot -= a[i * n + m] * a[m * n + i];
  a[i * n + i] = std::max(pivot, pivot_min);
}

/// Turns the last region's right-hand sides into its coefficients, in place.
void solve(ShapeStack& stack) noexcept {
  const std::size_t last = stack.count - 1, n = stack.capacity;
  const std::vector<double>& a = stack.factor;
  std::vector<double>& x = stack.right;
  for (std::size_t j = 1; j <= last; ++j) {
    for (std::size_t m = 0; m < j; ++m) x[j] -= a[j * n + m] * x[m];
  }
  for (std::size_t j = last + 1; j-- > 0;) {
    for (std::size_t m = j + 1; m <= last; ++m) x[j] -= a[j * n + m] * x[m];
    x[j] /= a[j * n + j];
  }
}

void add_corrected(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
                   ShapeStack& stack) noexcept {
  grow<FactorCorrected>(rest, local, region, hat_part, stack);
  const std::size_t last = stack.count - 1;
  Vec3* c_m = stack.vector_c_m.data() + last * stack.capacity;
  for (std::size_t j = 0; j <= last; ++j) {
    const ContactPoint& contact = stack.region[j].contact;
    c_m[j].setZero();
    if (!takes_part(stack, j)) continue;
    c_m[j] = (j == last ? contact.displacement_m : Vec3(Vec3::Zero())) -
             vector_at(rest, region.anchor_displacement_m, static_cast<std::size_t>(contact.patch), contact.place);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t j = 0; j <= last; ++j) stack.right[j] = c_m[j][axis];
    solve(stack);
    for (std::size_t j = 0; j <= last; ++j) c_m[j][axis] = stack.right[j];
  }
  for (std::size_t j = 0; j <= last; ++j) {
    stack.vector_total_m[j] += c_m[j];
    stack.vector_total_short_m[j] = stack.vector_total_m[j].cast<float>();
    stack.vector_c_short_m[last * stack.capacity + j] = c_m[j].cast<float>();
  }
  for (std::size_t k = 0; k < stack.anchor_total_m.size(); ++k) {
    stack.anchor_total_m[k] += region.anchor_displacement_m[k];
  }
}

void add_published(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
                   ShapeStack& stack) noexcept {
  grow<FactorPublished>(rest, local, region, hat_part_to_creases, stack);
  const std::size_t last = stack.count - 1;
  ShapeStack::Printed* printed = stack.printed.data() + last * rest.patches.size();
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const auto u = corner_displacements(patch, region.anchor_displacement_m);
    Vec3 mean_m = hat_of(stack, last, p).ceiling * region.contact.displacement_m;
    for (std::size_t k = 0; k < patch.corners; ++k) mean_m += u[k];
    printed[p].toward = mean_m.stableNormalized();
    for (std::size_t k = 0; k < corners_max; ++k) {
      printed[p].length_m[k] = u[k].norm();
      printed[p].angle_rad[k] = angle_to(u[k].squaredNorm() > 0.0 ? u[k] : mean_m, patch.corner_normal[k]);
    }
  }
  double* length_c_m = stack.length_c_m.data() + last * stack.capacity;
  double* angle_c_rad = stack.angle_c_rad.data() + last * stack.capacity;
  for (std::size_t j = 0; j <= last; ++j) {
    const ContactPoint& contact = stack.region[j].contact;
    length_c_m[j] = angle_c_rad[j] = 0.0;
    if (!takes_part(stack, j)) continue;
    const ShapeStack::Printed& here = printed[static_cast<std::size_t>(contact.patch)];
    const bool own = j == last;
    length_c_m[j] = (own ? contact.displacement_m.norm() : 0.0) - at_place(here.length_m, contact.place);
    angle_c_rad[j] =
        angle_to(own ? contact.displacement_m : here.toward, contact.normal) - at_place(here.angle_rad, contact.place);
  }
  for (std::size_t k = 0; k < stack.anchor_total_m.size(); ++k) {
    stack.anchor_total_m[k] += region.anchor_displacement_m[k];
  }
  for (double* c : {length_c_m, angle_c_rad}) {
    std::copy(c, c + last + 1, stack.right.begin());
    solve(stack);
    std::copy(stack.right.begin(), stack.right.begin() + static_cast<std::ptrdiff_t>(last) + 1, c);
  }
}

/// Heights of the hats from `first` to `last` over one block of their patch.
TOUCHSTONE_INLINE void raise_hats(const SurfacePatches& rest, std::size_t first, std::size_t last, std::size_t p,
                                  const VertexBlock& block, ShapeStack& stack) noexcept {
  const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
  for (std::size_t k = first; k <= last; ++k) {
    if (!hat_of(stack, k, p).reaches()) continue;
    const Hat hat(rest, hat_of(stack, k, p));
    float* height = stack.height[k].data();
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) height[v] = hat(begin + v);
  }
}

/// The weights of the corners over one block.
TOUCHSTONE_INLINE void take_weights(const SurfacePatches& rest, const VertexBlock& block, ShapeStack& stack) noexcept {
  for (std::size_t k = 0; k < corners_max; ++k) {
    std::copy(rest.weight[k].begin() + block.begin, rest.weight[k].begin() + block.end, stack.corner_weight[k].begin());
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
      if (!hat_of(stack, k, p).reaches()) continue;
      const float* height = stack.height[k].data();
      add(static_cast<float>(stack.length_c_m[i * stack.capacity + k]), height, count, length);
      add(static_cast<float>(stack.angle_c_rad[i * stack.capacity + k]), height, count, angle);
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
    for (std::size_t i = 0; i < stack.count; ++i) {
      increment(rest, stack, i, p, block, u);
      for (std::size_t axis = 0; axis < 3; ++axis) add(1.0f, u[axis].data(), block_vertices, out[axis]);
    }
  }

  static Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                           const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    const ShapeStack::Printed& here = stack.printed[i * rest.patches.size() + p];
    double length_m = at_place(here.length_m, place), angle_rad = at_place(here.angle_rad, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!hat_of(stack, k, p).reaches()) continue;
      const double height = hat_of(stack, k, p).at(place);
      length_m += height * stack.length_c_m[i * stack.capacity + k];
      angle_rad += height * stack.angle_c_rad[i * stack.capacity + k];
    }
    const double magnitude_m = std::max(0.0, length_m), theta = std::clamp(angle_rad, 0.0, std::numbers::pi);
    const Vec3 tangent = here.toward - here.toward.dot(at.normal) * at.normal;
    const double tangent2 = tangent.squaredNorm();
    const double to_unit = tangent2 > 1e-10 ? 1.0 / std::sqrt(tangent2) : 0.0;
    return magnitude_m * (std::cos(theta) * at.normal + std::sin(theta) * to_unit * tangent);
  }

  /// Sum of all u_i.
  static Vec3 global_at(const SurfacePatches& rest, const ShapeStack& stack, const scene::SurfaceQuery& at,
                        const PatchPlace& place) noexcept {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < stack.count; ++i) sum += increment_at(rest, stack, i, at, place);
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
    sum(rest, stack, stack.region[i].anchor_displacement_m, stack.vector_c_short_m.data() + i * stack.capacity, i + 1,
        p, out);
  }

  /// Sum of all u_i.
  TOUCHSTONE_INLINE static void whole(const SurfacePatches& rest, const ShapeStack& stack, std::size_t p,
                                      const VertexBlock&, Lane3& out) noexcept {
    sum(rest, stack, stack.anchor_total_m, stack.vector_total_short_m.data(), stack.count, p, out);
  }

  /// W U and the first hats by their coefficients.
  TOUCHSTONE_INLINE static void sum(const SurfacePatches& rest, const ShapeStack& stack,
                                    std::span<const Vec3> anchor_displacement_m, const Eigen::Vector3f* c_m,
                                    std::size_t hats, std::size_t p, Lane3& out) noexcept {
    const Patch& patch = rest.patches[p];
    std::array<Eigen::Vector3f, corners_max> corner;
    for (std::size_t k = 0; k < patch.corners; ++k) {
      corner[k] = anchor_displacement_m[static_cast<std::size_t>(patch.anchor[k])].cast<float>();
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
      for (std::size_t k = 0; k < patch.corners; ++k) add_vector(corner[k], stack.corner_weight[k]);
      for (std::size_t k = 0; k < hats; ++k) {
        if (hat_of(stack, k, p).reaches()) add_vector(c_m[k], stack.height[k]);
      }
      std::memcpy(out[0].data() + v, &x, sizeof x);
      std::memcpy(out[1].data() + v, &y, sizeof y);
      std::memcpy(out[2].data() + v, &z, sizeof z);
    }
  }

  static Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                           const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    Vec3 u_m = vector_at(rest, stack.region[i].anchor_displacement_m, p, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!hat_of(stack, k, p).reaches()) continue;
      u_m += hat_of(stack, k, p).at(place) * stack.vector_c_m[i * stack.capacity + k];
    }
    return u_m;
  }

  static Vec3 global_at(const SurfacePatches& rest, const ShapeStack& stack, const scene::SurfaceQuery& at,
                        const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    Vec3 u_m = vector_at(rest, stack.anchor_total_m, p, place);
    for (std::size_t k = 0; k < stack.count; ++k) {
      if (hat_of(stack, k, p).reaches()) u_m += hat_of(stack, k, p).at(place) * stack.vector_total_m[k];
    }
    return u_m;
  }
};

TOUCHSTONE_WIDE_LOOPS
void interpolate_several_published(const SurfacePatches& rest, ShapeStack& stack, SurfaceField& field) noexcept {
  Lane3 u, sum;
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    for (std::int32_t b = rest.patches[p].first_block; b < rest.patches[p].last_block; ++b) {
      const VertexBlock& block = rest.blocks[static_cast<std::size_t>(b)];
      const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
      for (Lane& lane : sum) std::fill(lane.begin(), lane.end(), 0.0f);
      for (std::size_t i = 0; i < stack.count; ++i) {
        raise_hats(rest, i, i, p, block, stack);
        Published::increment(rest, stack, i, p, block, u);
        for (std::size_t axis = 0; axis < 3; ++axis) add(1.0f, u[axis].data(), count, sum[axis]);
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::copy_n(sum[axis].data(), count, field.displacement_m[axis].data() + begin);
      }
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
void interpolate_several_corrected(const SurfacePatches& rest, ShapeStack& stack, SurfaceField& field) noexcept {
  // Without a contact point: that of the whole stack has a hat per region.
  interpolate_corrected(rest, stack.anchor_total_m, ContactPoint{}, field);
  float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
  for (std::size_t k = 0; k < stack.count; ++k) {
    for (std::size_t p = 0; p < stack.patches; ++p) {
      const HatPart& part = hat_of(stack, k, p);
      if (part.reaches()) raise(rest, rest.patches[p], part, stack.vector_total_m[k], x, y, z);
    }
  }
}

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
    r_m[static_cast<std::size_t>(v)] = std::sqrt(dx * dx + dy * dy + dz * dz);
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
  for (const std::size_t i : stack.near) {
    const ShapeStack::Reach& own = stack.reach[i];
    if (block.distance2_m2(own.p0_W_m) >= r_R_m * r_R_m) continue;
    raise_hats(rest, known, i, p, block, stack);
    for (std::size_t k = known == 0 ? 0 : known - 1; k < i; ++k) {
      if (!takes_part(stack, k)) continue;
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

template <class Formulation>
TOUCHSTONE_INLINE void apply_to_block(const SurfacePatches& rest, float r_R_m, std::size_t p, const VertexBlock& block,
                                      ShapeStack& stack, SurfaceField& field) noexcept {
  const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
  Lane3 sum{};
  take_weights(rest, block, stack);
  add_changes<Formulation>(rest, r_R_m, p, block, stack, sum);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float* out = field.displacement_m[axis].data() + begin;
#pragma GCC ivdep
    for (std::size_t v = 0; v < count; ++v) out[v] += sum[axis][v];
  }
}

template <class Formulation>
TOUCHSTONE_INLINE void apply_factors(const SurfacePatches& rest, const LocalConstants& local, ShapeStack& stack,
                                     SurfaceField& field) noexcept {
  const auto r_R_m = static_cast<float>(local.r_R_m);
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    // Never beyond the capacity it was given.
    stack.near.clear();
    for (std::size_t i = 0; i < stack.count; ++i) {
      if (patch.all.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m) stack.near.push_back(i);
    }
    if (stack.near.empty()) continue;
    for (std::int32_t b = patch.first_block; b < patch.last_block; ++b) {
      const VertexBlock& block = rest.blocks[static_cast<std::size_t>(b)];
      const bool reached = std::any_of(stack.near.begin(), stack.near.end(), [&](std::size_t i) {
        return block.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m;
      });
      if (reached) apply_to_block<Formulation>(rest, r_R_m, p, block, stack, field);
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
void apply_local_factors_published(const SurfacePatches& rest, const LocalConstants& local, ShapeStack& stack,
                                   SurfaceField& field) noexcept {
  apply_factors<Published>(rest, local, stack, field);
}

TOUCHSTONE_WIDE_LOOPS
void apply_local_factors_corrected(const SurfacePatches& rest, const LocalConstants& local, ShapeStack& stack,
                                   SurfaceField& field) noexcept {
  apply_factors<Corrected>(rest, local, stack, field);
}

template <class Formulation>
Vec3 displacement_at(const SurfacePatches& rest, const AnchorPoints& anchors, const ShapeStack& stack,
                     const LocalConstants* local, const scene::SurfaceQuery& at) noexcept {
  if (stack.count == 0) return Vec3::Zero();
  const PatchPlace place = anchors.at(at.patch, at.point_m);
  Vec3 u_m = Formulation::global_at(rest, stack, at, place);
  if (local == nullptr) return u_m;
  const auto r2_m2 = [&](std::size_t k) { return (at.point_m - stack.region[k].p0_W_m).squaredNorm(); };
  for (std::size_t i = 0; i < stack.count; ++i) {
    const double own_m2 = r2_m2(i);
    if (own_m2 >= local->r_R_m * local->r_R_m) continue;
    double change = Formulation::factor(*local, stack.region[i].size, std::sqrt(own_m2)) - 1.0;
    for (std::size_t k = 0; k < i; ++k) {
      if (takes_part(stack, k)) change *= Formulation::room(*local, stack.region[k].size, std::sqrt(r2_m2(k)));
    }
    u_m += change * Formulation::increment_at(rest, stack, i, at, place);
  }
  return u_m;
}

/// Lays the points on the stack's block of vertices.
TOUCHSTONE_INLINE void take_points(const AnchorPoints& anchors, int patch, const PointLanes& lanes,
                                   SurfacePatches& points) noexcept {
  PlaceColumns places;
  for (std::size_t k = 0; k < corners_max; ++k) places.weight[k] = points.weight[k].data();
  places.free = points.free.data();
  anchors.at(patch, {lanes.point_m[0], lanes.point_m[1], lanes.point_m[2]}, places);
  VertexBlock& block = points.blocks[0];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double *from_m = lanes.point_m[axis].data(), *from_normal = lanes.normal[axis].data();
    float *point_m = points.rest_W_m[axis].data(), *normal = points.normal[axis].data();
    std::array<float, lanes_at_once> low_m, high_m;
    low_m.fill(static_cast<float>(from_m[0]));
    high_m = low_m;
    // Columns never overlap.
#pragma GCC ivdep
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      point_m[v] = static_cast<float>(from_m[v]);
      normal[v] = static_cast<float>(from_normal[v]);
    }
    for (std::size_t v = 0; v < PointLanes::size; v += lanes_at_once) {
      for (std::size_t k = 0; k < lanes_at_once; ++k) {
        low_m[k] = point_m[v + k] < low_m[k] ? point_m[v + k] : low_m[k];
        high_m[k] = point_m[v + k] > high_m[k] ? point_m[v + k] : high_m[k];
      }
    }
    block.low_W_m[static_cast<int>(axis)] = *std::min_element(low_m.begin(), low_m.end());
    block.high_W_m[static_cast<int>(axis)] = *std::max_element(high_m.begin(), high_m.end());
  }
}

template <class Formulation>
TOUCHSTONE_INLINE void displacements_at(const AnchorPoints& anchors, const LocalConstants* local, int patch,
                                        ShapeStack& stack, PointLanes& lanes) noexcept {
  const auto p = static_cast<std::size_t>(patch);
  SurfacePatches& points = stack.points;
  take_points(anchors, patch, lanes, points);
  const VertexBlock& block = points.blocks[0];
  take_weights(points, block, stack);
  if (stack.count > 0) raise_hats(points, 0, stack.count - 1, p, block, stack);
  Lane3 sum;
  Formulation::whole(points, stack, p, block, sum);
  if (local != nullptr) {
    const auto r_R_m = static_cast<float>(local->r_R_m);
    stack.near.clear();
    for (std::size_t i = 0; i < stack.count; ++i) {
      if (block.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m) stack.near.push_back(i);
    }
    if (!stack.near.empty()) add_changes<Formulation>(points, r_R_m, p, block, stack, sum);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t v = 0; v < PointLanes::size; ++v) lanes.displacement_m[axis][v] = sum[axis][v];
  }
}

TOUCHSTONE_WIDE_LOOPS
void displacements_at_published(const AnchorPoints& anchors, const LocalConstants* local, int patch, ShapeStack& stack,
                                PointLanes& lanes) noexcept {
  displacements_at<Published>(anchors, local, patch, stack, lanes);
}

TOUCHSTONE_WIDE_LOOPS
void displacements_at_corrected(const AnchorPoints& anchors, const LocalConstants* local, int patch, ShapeStack& stack,
                                PointLanes& lanes) noexcept {
  displacements_at<Corrected>(anchors, local, patch, stack, lanes);
}

}  // namespace

ShapeStack::ShapeStack(const SurfacePatches& rest, const AnchorPoints& anchors, int max_regions)
    : capacity(static_cast<std::size_t>(max_regions)),
      patches(rest.patches.size()),
      region(capacity),
      takes_part(capacity, 0),
      hat(capacity * patches),
      factor(capacity * capacity, 0.0),
      right(capacity, 0.0),
      vector_c_m(capacity * capacity, Vec3(Vec3::Zero())),
      vector_c_short_m(capacity * capacity),
      vector_total_m(capacity, Vec3(Vec3::Zero())),
      vector_total_short_m(capacity),
      anchor_total_m(anchors.points_m().size(), Vec3(Vec3::Zero())),
      length_c_m(capacity * capacity, 0.0),
      angle_c_rad(capacity * capacity, 0.0),
      printed(capacity * rest.patches.size()),
      height(capacity),
      reach(capacity) {
  near.reserve(capacity);
  points.patches = rest.patches;
  points.blocks = {{0, block_vertices, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()}};
  for (Columns3* columns : {&points.rest_W_m, &points.normal}) columns->fill(std::vector<float>(block_vertices));
  points.weight.fill(std::vector<float>(block_vertices));
  points.free.assign(block_vertices, 0.0f);
}

void ShapeStack::clear() noexcept {
  count = 0;
  std::fill(vector_total_m.begin(), vector_total_m.end(), Vec3(Vec3::Zero()));
  std::fill(anchor_total_m.begin(), anchor_total_m.end(), Vec3(Vec3::Zero()));
}

std::size_t ShapeStack::memory_bytes() const noexcept {
  return sizeof(ShapeStack) +
         capacity * (sizeof(RegionShape) + sizeof(Vec3) + sizeof(double) + sizeof(Lane) + sizeof(Reach) +
                     sizeof(std::size_t)) +
         capacity * capacity * (sizeof(Vec3) + sizeof(Eigen::Vector3f) + 3 * sizeof(double)) +
         anchor_total_m.size() * sizeof(Vec3) + printed.size() * sizeof(Printed) + points.memory_bytes() +
         hat.size() * sizeof(HatPart);
}

const SeveralRegions several_regions_published{add_published, interpolate_several_published,
                                               apply_local_factors_published, displacement_at<Published>,
                                               displacements_at_published};
const SeveralRegions several_regions_corrected{add_corrected, interpolate_several_corrected,
                                               apply_local_factors_corrected, displacement_at<Corrected>,
                                               displacements_at_corrected};

}  // namespace touchstone::fast
