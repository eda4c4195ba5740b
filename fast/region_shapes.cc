#include "fast/region_shapes.h"

#include "fast/local_factor_kernel.h"
#include "fast/patch_kernels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Least part of a hat that must be a region's own. Two regions a part s of the patch apart leave about 4 s.
constexpr double pivot_min = 1.0 / 32.0;

/// Vertices of one block on their way through a pass.
using Lane = std::array<float, block_vertices>;
using Lane3 = std::array<Lane, 3>;

/// The hat over `top` at another place of the same patch.
double hat_at(const PatchPlace& top, const PatchPlace& place) noexcept {
  double height = place.edge[0] / std::max(top.edge[0], 1e-9);
  for (std::size_t k = 1; k < corners_max; ++k) height = std::min(height, place.edge[k] / std::max(top.edge[k], 1e-9));
  return height;
}

bool on_patch(const ShapeStack& stack, std::size_t k, std::size_t patch) noexcept {
  return stack.takes_part[k] && static_cast<std::size_t>(stack.region[k].contact.patch) == patch;
}

/// h_k(p0_j)
double hat_at_contact(const ShapeStack& stack, std::size_t k, std::size_t j) noexcept {
  if (k == j) return 1.0;
  const ContactPoint& top = stack.region[k].contact;
  return on_patch(stack, j, static_cast<std::size_t>(top.patch)) && stack.takes_part[k]
             ? hat_at(top.place, stack.region[j].contact.place)
             : 0.0;
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
void grow(const RegionShape& region, ShapeStack& stack) noexcept {
  const std::size_t i = stack.count++, n = stack.capacity;
  stack.region[i] = region;
  stack.takes_part[i] = region.contact.displacement_m.squaredNorm() > 0.0 && !region.contact.place.held();
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

void add_corrected(const SurfacePatches& rest, const RegionShape& region, ShapeStack& stack) noexcept {
  grow(region, stack);
  const std::size_t last = stack.count - 1;
  Vec3* c_m = stack.vector_c_m.data() + last * stack.capacity;
  for (std::size_t j = 0; j <= last; ++j) {
    const ContactPoint& contact = stack.region[j].contact;
    c_m[j].setZero();
    if (!stack.takes_part[j]) continue;
    c_m[j] = (j == last ? contact.displacement_m : Vec3(Vec3::Zero())) -
             vector_at(rest, region.anchor_displacement_m, static_cast<std::size_t>(contact.patch), contact.place);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t j = 0; j <= last; ++j) stack.right[j] = c_m[j][axis];
    solve(stack);
    for (std::size_t j = 0; j <= last; ++j) c_m[j][axis] = stack.right[j];
  }
  for (std::size_t j = 0; j <= last; ++j) stack.vector_total_m[j] += c_m[j];
  for (std::size_t k = 0; k < stack.anchor_total_m.size(); ++k) {
    stack.anchor_total_m[k] += region.anchor_displacement_m[k];
  }
}

void add_published(const SurfacePatches& rest, const RegionShape& region, ShapeStack& stack) noexcept {
  grow(region, stack);
  const std::size_t last = stack.count - 1;
  ShapeStack::Printed* printed = stack.printed.data() + last * rest.patches.size();
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const auto u = corner_displacements(patch, region.anchor_displacement_m);
    Vec3 mean_m = on_patch(stack, last, p) ? region.contact.displacement_m : Vec3(Vec3::Zero());
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
    if (!stack.takes_part[j]) continue;
    const ShapeStack::Printed& here = printed[static_cast<std::size_t>(contact.patch)];
    const bool own = j == last;
    length_c_m[j] = (own ? contact.displacement_m.norm() : 0.0) - at_place(here.length_m, contact.place);
    angle_c_rad[j] =
        angle_to(own ? contact.displacement_m : here.toward, contact.normal) - at_place(here.angle_rad, contact.place);
  }
  for (double* c : {length_c_m, angle_c_rad}) {
    std::copy(c, c + last + 1, stack.right.begin());
    solve(stack);
    std::copy(stack.right.begin(), stack.right.begin() + static_cast<std::ptrdiff_t>(last) + 1, c);
  }
}

/// Adds a hat times `rise` to a lane over the block.
TOUCHSTONE_INLINE void add_hat(const Hat& hat, std::size_t begin, std::size_t count, float rise, Lane& lane) noexcept {
  for (std::size_t v = 0; v < count; ++v) lane[v] += hat(begin + v) * rise;
}

/// u_i over one block and at one point, as printed.
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
    for (std::size_t v = 0; v < count; ++v) {
      length[v] = length_at(begin + v);
      angle[v] = angle_at(begin + v);
    }
    for (std::size_t k = 0; k <= i; ++k) {
      if (!on_patch(stack, k, p)) continue;
      const Hat hat(rest, stack.region[k].contact.place);
      add_hat(hat, begin, count, static_cast<float>(stack.length_c_m[i * stack.capacity + k]), length);
      add_hat(hat, begin, count, static_cast<float>(stack.angle_c_rad[i * stack.capacity + k]), angle);
    }
    const Eigen::Vector3f toward = here.toward.cast<float>();
    const float *nx = rest.normal[0].data() + begin, *ny = rest.normal[1].data() + begin;
    const float* nz = rest.normal[2].data() + begin;
    for (std::size_t v = 0; v < count; ++v) {
      const Turned u = turned(length[v], angle[v], toward, nx[v], ny[v], nz[v]);
      out[0][v] = u.x;
      out[1][v] = u.y;
      out[2][v] = u.z;
    }
  }

  static Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                           const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    const ShapeStack::Printed& here = stack.printed[i * rest.patches.size() + p];
    double length_m = at_place(here.length_m, place), angle_rad = at_place(here.angle_rad, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!on_patch(stack, k, p)) continue;
      const double height = hat_at(stack.region[k].contact.place, place);
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
                                          std::size_t p, const VertexBlock& block, Lane3& out) noexcept {
    const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
    const auto u = corner_displacements(rest.patches[p], stack.region[i].anchor_displacement_m);
    for (int axis = 0; axis < 3; ++axis) {
      const Weighted weighted(rest, {u[0][axis], u[1][axis], u[2][axis], u[3][axis]});
      Lane& lane = out[static_cast<std::size_t>(axis)];
      for (std::size_t v = 0; v < count; ++v) lane[v] = weighted(begin + v);
    }
    for (std::size_t k = 0; k <= i; ++k) {
      if (!on_patch(stack, k, p)) continue;
      const Hat hat(rest, stack.region[k].contact.place);
      const Eigen::Vector3f c_m = stack.vector_c_m[i * stack.capacity + k].cast<float>();
      for (std::size_t v = 0; v < count; ++v) {
        const float height = hat(begin + v);
        out[0][v] += height * c_m.x();
        out[1][v] += height * c_m.y();
        out[2][v] += height * c_m.z();
      }
    }
  }

  static Vec3 increment_at(const SurfacePatches& rest, const ShapeStack& stack, std::size_t i,
                           const scene::SurfaceQuery& at, const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    Vec3 u_m = vector_at(rest, stack.region[i].anchor_displacement_m, p, place);
    for (std::size_t k = 0; k <= i; ++k) {
      if (!on_patch(stack, k, p)) continue;
      u_m += hat_at(stack.region[k].contact.place, place) * stack.vector_c_m[i * stack.capacity + k];
    }
    return u_m;
  }

  static Vec3 global_at(const SurfacePatches& rest, const ShapeStack& stack, const scene::SurfaceQuery& at,
                        const PatchPlace& place) noexcept {
    const auto p = static_cast<std::size_t>(at.patch);
    Vec3 u_m = vector_at(rest, stack.anchor_total_m, p, place);
    for (std::size_t k = 0; k < stack.count; ++k) {
      if (on_patch(stack, k, p)) u_m += hat_at(stack.region[k].contact.place, place) * stack.vector_total_m[k];
    }
    return u_m;
  }
};

TOUCHSTONE_WIDE_LOOPS
void interpolate_several_published(const SurfacePatches& rest, const ShapeStack& stack, SurfaceField& field) noexcept {
  for (auto& column : field.displacement_m) std::fill(column.begin(), column.end(), 0.0f);
  Lane3 u;
  for (std::size_t i = 0; i < stack.count; ++i) {
    for (std::size_t p = 0; p < rest.patches.size(); ++p) {
      for (std::int32_t b = rest.patches[p].first_block; b < rest.patches[p].last_block; ++b) {
        const VertexBlock& block = rest.blocks[static_cast<std::size_t>(b)];
        Published::increment(rest, stack, i, p, block, u);
        const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          float* out = field.displacement_m[axis].data() + begin;
          for (std::size_t v = 0; v < count; ++v) out[v] += u[axis][v];
        }
      }
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
void interpolate_several_corrected(const SurfacePatches& rest, const ShapeStack& stack, SurfaceField& field) noexcept {
  // Without a contact point: that of the whole stack has a hat per region.
  interpolate_corrected(rest, stack.anchor_total_m, ContactPoint{}, field);
  float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
  for (std::size_t k = 0; k < stack.count; ++k) {
    if (!stack.takes_part[k]) continue;
    const ContactPoint& contact = stack.region[k].contact;
    const Patch& patch = rest.patches[static_cast<std::size_t>(contact.patch)];
    const Hat hat(rest, contact.place);
    const Eigen::Vector3f rise = stack.vector_total_m[k].cast<float>();
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    // Columns never overlap.
#pragma GCC ivdep
    for (std::size_t v = begin; v < end; ++v) {
      const float height = hat(v);
      x[v] += height * rise.x();
      y[v] += height * rise.y();
      z[v] += height * rise.z();
    }
  }
}

/// Where a region's local factor is at work: its terms and single precision place.
struct Reach {
  FactorTerms terms;
  Eigen::Vector3f p0_m;
};
template <class Formulation>
Reach reach(const LocalConstants& local, const RegionShape& region) noexcept {
  return {Formulation::Factor::terms(local, region.size), region.p0_W_m.cast<float>()};
}

TOUCHSTONE_INLINE float distance_m(const SurfacePatches& rest, std::size_t v, const Eigen::Vector3f& p_m) noexcept {
  const float dx = rest.rest_W_m[0][v] - p_m.x(), dy = rest.rest_W_m[1][v] - p_m.y();
  const float dz = rest.rest_W_m[2][v] - p_m.z();
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

/// Adds (w_i - 1) u_i over one block.
template <class Formulation>
TOUCHSTONE_INLINE void apply_to_block(const SurfacePatches& rest, const LocalConstants& local, const ShapeStack& stack,
                                      std::size_t i, const Reach& own, std::size_t p, const VertexBlock& block,
                                      SurfaceField& field) noexcept {
  const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
  const auto r_R_m = static_cast<float>(local.r_R_m);
  Lane change;
  for (std::size_t v = 0; v < count; ++v) {
    const float r_m = distance_m(rest, begin + v, own.p0_m), inside = Formulation::Factor::at(own.terms, r_m) - 1.0f;
    change[v] = r_m < r_R_m ? inside : 0.0f;
  }
  for (std::size_t k = 0; k < i; ++k) {
    if (!stack.takes_part[k]) continue;
    const Reach earlier = reach<Formulation>(local, stack.region[k]);
    const float rim_m = earlier.terms.rim_m + earlier.terms.C_r_m;
    if (block.distance2_m2(earlier.p0_m) > rim_m * rim_m) continue;
    for (std::size_t v = 0; v < count; ++v) {
      change[v] *= Formulation::Factor::room(earlier.terms, distance_m(rest, begin + v, earlier.p0_m));
    }
  }
  Lane3 u;
  Formulation::increment(rest, stack, i, p, block, u);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float* out = field.displacement_m[axis].data() + begin;
    for (std::size_t v = 0; v < count; ++v) out[v] += change[v] * u[axis][v];
  }
}

template <class Formulation>
TOUCHSTONE_INLINE void apply_factors(const SurfacePatches& rest, const LocalConstants& local, const ShapeStack& stack,
                                     SurfaceField& field) noexcept {
  for (std::size_t i = 0; i < stack.count; ++i) {
    const RegionShape& region = stack.region[i];
    const Reach own = reach<Formulation>(local, region);
    const auto r_R_m2 = static_cast<float>(local.r_R_m * local.r_R_m);
    for (std::size_t p = 0; p < rest.patches.size(); ++p) {
      const Patch& patch = rest.patches[p];
      if ((patch.center_W_m - region.p0_W_m).norm() > patch.radius_m + local.r_R_m) continue;
      for (std::int32_t b = patch.first_block; b < patch.last_block; ++b) {
        const VertexBlock& block = rest.blocks[static_cast<std::size_t>(b)];
        if (block.distance2_m2(own.p0_m) >= r_R_m2) continue;
        apply_to_block<Formulation>(rest, local, stack, i, own, p, block, field);
      }
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
void apply_local_factors_published(const SurfacePatches& rest, const LocalConstants& local, const ShapeStack& stack,
                                   SurfaceField& field) noexcept {
  apply_factors<Published>(rest, local, stack, field);
}

TOUCHSTONE_WIDE_LOOPS
void apply_local_factors_corrected(const SurfacePatches& rest, const LocalConstants& local, const ShapeStack& stack,
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
      if (stack.takes_part[k]) change *= Formulation::room(*local, stack.region[k].size, std::sqrt(r2_m2(k)));
    }
    u_m += change * Formulation::increment_at(rest, stack, i, at, place);
  }
  return u_m;
}

}  // namespace

ShapeStack::ShapeStack(const SurfacePatches& rest, const AnchorPoints& anchors, int max_regions)
    : capacity(static_cast<std::size_t>(max_regions)),
      region(capacity),
      takes_part(capacity, false),
      factor(capacity * capacity, 0.0),
      right(capacity, 0.0),
      vector_c_m(capacity * capacity, Vec3(Vec3::Zero())),
      vector_total_m(capacity, Vec3(Vec3::Zero())),
      anchor_total_m(anchors.points_m().size(), Vec3(Vec3::Zero())),
      length_c_m(capacity * capacity, 0.0),
      angle_c_rad(capacity * capacity, 0.0),
      printed(capacity * rest.patches.size()) {}

void ShapeStack::clear() noexcept {
  count = 0;
  std::fill(vector_total_m.begin(), vector_total_m.end(), Vec3(Vec3::Zero()));
  std::fill(anchor_total_m.begin(), anchor_total_m.end(), Vec3(Vec3::Zero()));
}

std::size_t ShapeStack::memory_bytes() const noexcept {
  return sizeof(ShapeStack) + capacity * (sizeof(RegionShape) + sizeof(Vec3) + sizeof(double)) +
         capacity * capacity * (sizeof(Vec3) + 3 * sizeof(double)) + anchor_total_m.size() * sizeof(Vec3) +
         printed.size() * sizeof(Printed);
}

const SeveralRegions several_regions_published{add_published, interpolate_several_published,
                                               apply_local_factors_published, displacement_at<Published>};
const SeveralRegions several_regions_corrected{add_corrected, interpolate_several_corrected,
                                               apply_local_factors_corrected, displacement_at<Corrected>};

}  // namespace touchstone::fast
