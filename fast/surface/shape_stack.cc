#include "fast/surface/shape_stack.h"

#include "fast/surface/patch_kernels.h"
#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Adds the parts of a region that both formulations use.
template <class Factor>
void add_region(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
                decltype(hat_part)* part_of, ShapeStack& stack) noexcept {
  const std::size_t i = stack.count();
  stack.hats.add(rest, region.contact, part_of);
  stack.region[i] = region;
  if (local != nullptr) stack.reach[i] = {Factor::terms(*local, region.size), region.p0_W_m.cast<float>()};
  for (std::size_t k = 0; k < stack.anchor_total_m.size(); ++k) {
    stack.anchor_total_m[k] += region.anchor_displacement_m[k];
  }
}

}  // namespace

void add_region_corrected(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
                          ShapeStack& stack) noexcept {
  add_region<FactorCorrected>(rest, local, region, hat_part, stack);
  const std::size_t last = stack.count() - 1;
  Vec3* c_m = stack.vector_c_m.data() + last * stack.hats.capacity();
  for (std::size_t j = 0; j <= last; ++j) {
    const ContactPoint& contact = stack.region[j].contact;
    c_m[j].setZero();
    if (!stack.hats.takes_part(j)) continue;
    c_m[j] = (j == last ? contact.displacement_m : Vec3(Vec3::Zero())) -
             vector_at(rest, region.anchor_displacement_m, static_cast<std::size_t>(contact.patch), contact.place);
  }
  stack.hats.solve(c_m);
  for (std::size_t j = 0; j <= last; ++j) {
    stack.vector_total_m[j] += c_m[j];
    stack.vector_total_short_m[j] = stack.vector_total_m[j].cast<float>();
    stack.vector_c_short_m[last * stack.hats.capacity() + j] = c_m[j].cast<float>();
  }
}

void add_region_published(const SurfacePatches& rest, const LocalConstants* local, const RegionShape& region,
                          ShapeStack& stack) noexcept {
  add_region<FactorPublished>(rest, local, region, hat_part_to_creases, stack);
  const std::size_t last = stack.count() - 1;
  ShapeStack::Printed* printed = stack.printed.data() + last * rest.patches.size();
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const auto u = corner_displacements(patch, region.anchor_displacement_m);
    Vec3 mean_m = stack.hats.part(last, p).ceiling * region.contact.displacement_m;
    for (std::size_t k = 0; k < patch.corners; ++k) mean_m += u[k];
    printed[p].toward = mean_m.stableNormalized();
    for (std::size_t k = 0; k < corners_max; ++k) {
      printed[p].length_m[k] = u[k].norm();
      printed[p].angle_rad[k] = angle_to(u[k].squaredNorm() > 0.0 ? u[k] : mean_m, patch.corner_normal[k]);
    }
  }
  double* length_c_m = stack.length_c_m.data() + last * stack.hats.capacity();
  double* angle_c_rad = stack.angle_c_rad.data() + last * stack.hats.capacity();
  for (std::size_t j = 0; j <= last; ++j) {
    const ContactPoint& contact = stack.region[j].contact;
    length_c_m[j] = angle_c_rad[j] = 0.0;
    if (!stack.hats.takes_part(j)) continue;
    const ShapeStack::Printed& here = nth(printed, contact.patch);
    const bool own = j == last;
    length_c_m[j] = (own ? contact.displacement_m.norm() : 0.0) - at_place(here.length_m, contact.place);
    angle_c_rad[j] =
        angle_to(own ? contact.displacement_m : here.toward, contact.normal) - at_place(here.angle_rad, contact.place);
  }
  stack.hats.solve(length_c_m);
  stack.hats.solve(angle_c_rad);
}

PassScratch::PassScratch(const SurfacePatches& rest, std::size_t max_regions) : height(max_regions) {
  near.reserve(max_regions);
  points.patches = rest.patches;
  points.blocks = {{0, block_vertices, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()}};
  for (Columns3* columns : {&points.rest_W_m, &points.normal}) columns->fill(std::vector<float>(block_vertices));
  points.weight.fill(std::vector<float>(block_vertices));
  points.free.assign(block_vertices, 0.0f);
}

std::size_t PassScratch::memory_bytes() const noexcept {
  return height.size() * sizeof(Lane) + near.capacity() * sizeof(std::size_t) + points.memory_bytes();
}

ShapeStack::ShapeStack(const SurfacePatches& rest, const AnchorPoints& anchors, int max_regions)
    : hats(rest.patches.size(), static_cast<std::size_t>(max_regions)),
      region(hats.capacity()),
      reach(hats.capacity()),
      anchor_total_m(anchors.points_m().size(), Vec3(Vec3::Zero())),
      vector_c_m(hats.capacity() * hats.capacity(), Vec3(Vec3::Zero())),
      vector_total_m(hats.capacity(), Vec3(Vec3::Zero())),
      vector_c_short_m(vector_c_m.size()),
      vector_total_short_m(hats.capacity()),
      length_c_m(vector_c_m.size(), 0.0),
      angle_c_rad(vector_c_m.size(), 0.0),
      printed(hats.capacity() * rest.patches.size()),
      scratch(rest, hats.capacity()) {}

void ShapeStack::clear() noexcept {
  hats.clear();
  std::fill(vector_total_m.begin(), vector_total_m.end(), Vec3(Vec3::Zero()));
  std::fill(anchor_total_m.begin(), anchor_total_m.end(), Vec3(Vec3::Zero()));
}

std::size_t ShapeStack::memory_bytes() const noexcept {
  return sizeof(ShapeStack) + hats.memory_bytes() + scratch.memory_bytes() + printed.size() * sizeof(Printed) +
         region.size() * (sizeof(RegionShape) + sizeof(Reach)) + anchor_total_m.size() * sizeof(Vec3) +
         vector_c_m.size() * (sizeof(Vec3) + sizeof(Eigen::Vector3f) + 2 * sizeof(double)) +
         vector_total_m.size() * (sizeof(Vec3) + sizeof(Eigen::Vector3f));
}

}  // namespace touchstone::fast
