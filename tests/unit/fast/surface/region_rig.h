// A body with several contact regions pressed into it, for the tests of their shape.
#pragma once

#include "fast/step/model.h"
#include "fast/surface/region_shapes.h"
#include "support/press.h"

#include <algorithm>
#include <random>
#include <vector>

namespace touchstone::test {

struct Form {
  const char* name;
  const fast::SeveralRegions* several;
  fast::Interpolate interpolate;
  fast::ApplyLocalFactor apply_local_factor;
};
inline const Form forms[] = {
    {"published", &fast::several_regions_published, fast::interpolate_published, fast::apply_local_factor_published},
    {"corrected", &fast::several_regions_corrected, fast::interpolate_corrected, fast::apply_local_factor_corrected}};

inline constexpr fast::LocalConstants local{0.2, 0.002, 0.015};

struct Rig {
  explicit Rig(const scene::Scene& scene)
      : model(scene), field(model.rest), stack(model.rest, *model.anchors, 10), anchor_m(10) {}
  fast::FastModel model;
  fast::SurfaceField field;
  fast::ShapeStack stack;
  std::vector<std::vector<scene::Vec3>> anchor_m;  ///< U_i
  std::vector<fast::RegionShape> regions;

  /// A region at the surface point nearest to p, with random anchor displacements.
  void press(const scene::Vec3& p_m, const scene::Vec3& displacement_m, double area_m2 = 3e-5) {
    const std::size_t i = regions.size();
    std::mt19937 random(static_cast<unsigned>(17 + i));
    std::uniform_real_distribution<double> draw(-4e-4, 4e-4);
    anchor_m[i].clear();
    for (const bool held : model.skeleton.held) {
      anchor_m[i].push_back(held ? scene::Vec3(scene::Vec3::Zero())
                                 : scene::Vec3(draw(random), draw(random), draw(random)));
    }
    const scene::SurfaceQuery at = model.body->query(p_m);
    fast::RegionShape region;
    region.anchor_displacement_m = anchor_m[i];
    region.p0_W_m = at.point_m;
    region.size = {40, area_m2};
    region.contact.patch = at.patch;
    region.contact.place = model.anchors->at(at.patch, at.point_m);
    region.contact.normal = at.normal;
    region.contact.displacement_m = displacement_m;
    regions.push_back(region);
  }
  void stack_up(const fast::SeveralRegions& several, std::size_t count = 99) {
    stack.clear();
    for (std::size_t i = 0; i < std::min(count, regions.size()); ++i)
      several.add(model.rest, &local, regions[i], stack);
  }
  void shape(const fast::SeveralRegions& several, const fast::LocalConstants* factor) {
    several.interpolate(model.rest, stack, field);
    if (factor != nullptr) several.apply_local_factors(model.rest, *factor, stack, field);
  }
  [[nodiscard]] scene::Vec3 at(const fast::SeveralRegions& several, const fast::LocalConstants* factor,
                               const scene::Vec3& p_m) const {
    return several.displacement_at(model.rest, *model.anchors, stack, factor, model.body->query(p_m));
  }
  [[nodiscard]] scene::Vec3 vertex_m(int v) const {
    const auto k = static_cast<std::size_t>(v);
    return scene::Vec3(field.displacement_m[0][k], field.displacement_m[1][k], field.displacement_m[2][k]);
  }
  /// The vertex as a point of its own patch: on an edge a query may return the neighbouring patch.
  [[nodiscard]] scene::SurfaceQuery rest_vertex(int v) const {
    int patch = 0;
    while (v >= model.rest.patches[static_cast<std::size_t>(patch)].end) ++patch;
    return {0.0, model.surface.points_m.col(v), model.surface.normals.col(v), patch};
  }
};

/// Up to four regions on the upper half, two of them on one patch and near each other.
inline void press_four(Rig& s, std::size_t count) {
  const bool box = s.model.rest.patches.size() == 6;
  const scene::Vec3 places[] = {scene::Vec3(0.0061, 0.0043, 0.06),
                                box ? scene::Vec3(-0.0077, 0.0029, 0.06) : scene::Vec3(0.0177, 0.0069, 0.055),
                                scene::Vec3(0.029, 0.0131, 0.051), scene::Vec3(0.0132, -0.0111, 0.06)};
  const scene::Vec3 displacements[] = {scene::Vec3(1e-4, 2e-4, -2e-3), scene::Vec3(-3e-4, 1e-4, -1.5e-3),
                                       scene::Vec3(-1.2e-3, 2e-4, -3e-4), scene::Vec3(2e-4, -1e-4, -2.2e-3)};
  for (std::size_t i = 0; i < count; ++i) s.press(places[i], displacements[i]);
}

}  // namespace touchstone::test
