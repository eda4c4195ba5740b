#include "fast/surface/region_passes.h"

#include "fast/surface/region_kernels.h"
#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::fast {
namespace {

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
    // Never exceeds the reserved capacity.
    stack.scratch.near.clear();
    for (std::size_t i = 0; i < stack.count(); ++i) {
      if (patch.all.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m) stack.scratch.near.push_back(i);
    }
    if (stack.scratch.near.empty()) continue;
    for (std::int32_t b = patch.first_block; b < patch.last_block; ++b) {
      const VertexBlock& block = nth(rest.blocks, b);
      const bool reached = std::any_of(stack.scratch.near.begin(), stack.scratch.near.end(), [&](std::size_t i) {
        return block.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m;
      });
      if (reached) apply_to_block<Formulation>(rest, r_R_m, p, block, stack, field);
    }
  }
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void interpolate_several_published(const SurfacePatches& rest, ShapeStack& stack, SurfaceField& field) noexcept {
  Lane3 u, sum;
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    for (std::int32_t b = rest.patches[p].first_block; b < rest.patches[p].last_block; ++b) {
      const VertexBlock& block = nth(rest.blocks, b);
      const auto begin = static_cast<std::size_t>(block.begin), count = static_cast<std::size_t>(block.end) - begin;
      for (Lane& lane : sum) std::fill(lane.begin(), lane.end(), 0.0f);
      for (std::size_t i = 0; i < stack.count(); ++i) {
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
  // Without a contact point: in a stack every region has its own kernel function.
  interpolate_corrected(rest, stack.anchor_total_m, ContactPoint{}, field);
  float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
  for (std::size_t k = 0; k < stack.count(); ++k) {
    for (std::size_t p = 0; p < rest.patches.size(); ++p) {
      const HatPart& part = stack.hats.part(k, p);
      if (part.reaches()) raise(rest, rest.patches[p], part, stack.vector_total_m[k], x, y, z);
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

}  // namespace touchstone::fast
