#include "fast/step/model.h"

namespace touchstone::fast {
namespace {

/// A cell is as accurate as several samples.
constexpr int samples_per_cell = 4;
/// The contact of a convex tool halves as many cells as it needs. Several regions are told apart by the distance
/// between whole ones.
constexpr int most_cells_if_convex = 500;

ToolSamples samples_of(const scene::Scene& scene) {
  const int count = scene.fast.tool_samples;
  if (scene.fast.formulation == scene::Formulation::published) return sample_tool(scene.tool, count);
  const int cells = std::max(1, count / samples_per_cell);
  return cell_tool(scene.tool, scene.tool.convex() ? std::min(cells, most_cells_if_convex) : cells);
}

Formulas formulas_of(const scene::Scene& scene, const BeamSkeleton& skeleton) {
  const scene::FastSettings& fast = scene.fast;
  const SplitForce split_force = split_force_of(fast.formulation, skeleton);
  Formulas formulas;
  if (fast.formulation == scene::Formulation::published) {
    formulas = {distribute_mass_published, resolve_friction_published,   split_force,
                interpolate_published,     apply_local_factor_published, several_regions_published};
  } else {
    formulas = {distribute_mass_corrected, resolve_friction_corrected,   split_force,
                interpolate_corrected,     apply_local_factor_corrected, several_regions_corrected};
  }
  if (!scene.contact.friction) formulas.resolve_friction = nullptr;
  if (fast.C_n == 0.0) formulas.apply_local_factor = nullptr;
  return formulas;
}

}  // namespace

FastModel::FastModel(const scene::Scene& scene)
    : body(scene::body_shape(scene.body)),
      detection(detection_for(*body)),
      tool(samples_of(scene)),
      law(scene.contact),
      friction(scene.contact.friction ? std::optional<FrictionLaw>(*scene.contact.friction) : std::nullopt),
      anchors(anchor_points(scene.body, *body)),
      skeleton(beam_skeleton(*anchors, scene)),
      local{scene.fast.C_n, scene.fast.C_r_m, scene.fast.r_R_m},
      surface(scene::tessellate(*body, scene.fast.triangles)),
      rest(surface_patches(surface, *anchors)),
      normals(normal_stencils(surface)),
      formulas(formulas_of(scene, skeleton)),
      max_regions(scene.tool.convex() ? 1 : scene.fast.max_regions) {
  if (max_regions > 1) clusters = std::make_unique<const ClusterGrid>(cluster_grid(tool, scene.contact.r_th_m));
  if (scene.fast.formulation != scene::Formulation::published) cells.emplace();
}

void FastModel::set_constants(const scene::Scene& scene) {
  law = ContactLaw(scene.contact);
  friction = scene.contact.friction ? std::optional<FrictionLaw>(*scene.contact.friction) : std::nullopt;
  skeleton.set_constants(scene.fast);
  local = {scene.fast.C_n, scene.fast.C_r_m, scene.fast.r_R_m};
  formulas = formulas_of(scene, skeleton);
  if (max_regions > 1 && clusters->r_th_m != scene.contact.r_th_m)
    clusters = std::make_unique<const ClusterGrid>(cluster_grid(tool, scene.contact.r_th_m));
}

std::size_t FastModel::memory_bytes() const noexcept {
  const auto vertices = static_cast<std::size_t>(surface.vertex_count());
  return sizeof(FastModel) + tool.memory_bytes() + rest.memory_bytes() + normals.memory_bytes() +
         skeleton.anchor_m.size() * (sizeof(scene::Vec3) + sizeof(double)) + vertices * 7 * sizeof(double) +
         surface.triangles.size() * sizeof(surface.triangles[0]) + (cells ? cells->halves.memory_bytes() : 0);
}

}  // namespace touchstone::fast
