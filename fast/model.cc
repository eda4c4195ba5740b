#include "fast/model.h"

namespace touchstone::fast {
namespace {

Detection detection_of(const scene::Body& body, const scene::Shape& shape) {
  switch (body.shape) {
    case scene::BodyShape::box:
      return detection_for(static_cast<const scene::Box&>(shape));
    case scene::BodyShape::sphere:
      return detection_for(static_cast<const scene::Sphere&>(shape));
    default:
      break;
  }
  return {};
}

ToolSamples samples_of(const scene::Scene& scene) {
  switch (scene.tool.shape) {
    case scene::ToolShape::sphere:
      return sample_tool(scene::Sphere(scene::Vec3::Zero(), scene.tool.radius_m), scene.fast.tool_samples);
    default:
      break;
  }
  return {};
}

Formulas formulas_of(const scene::FastSettings& fast) {
  Formulas formulas;
  switch (fast.formulation) {
    case scene::Formulation::published:
      formulas = {distribute_mass_published, split_force_published, interpolate_published,
                  apply_local_factor_published};
      break;
    case scene::Formulation::corrected:
      formulas = {distribute_mass_corrected, split_force_corrected, interpolate_corrected,
                  apply_local_factor_corrected};
      break;
  }
  if (fast.C_n == 0.0) formulas.apply_local_factor = nullptr;
  return formulas;
}

}  // namespace

FastModel::FastModel(const scene::Scene& scene)
    : body(scene::body_shape(scene.body)),
      detection(detection_of(scene.body, *body)),
      tool(samples_of(scene)),
      law(scene.contact.k1_n_per_m, scene.contact.k3_n_per_m3),
      anchors(anchor_points(scene.body, *body)),
      skeleton(beam_skeleton(*anchors, scene)),
      local{scene.fast.C_n, scene.fast.C_r_m, scene.fast.r_R_m},
      surface(scene::tessellate(*body, scene.fast.triangles)),
      rest(surface_patches(surface, *anchors)),
      normals(normal_stencils(surface)),
      formulas(formulas_of(scene.fast)),
      max_regions(scene.tool.convex() ? 1 : scene.fast.max_regions) {}

std::size_t FastModel::memory_bytes() const noexcept {
  const auto vertices = static_cast<std::size_t>(surface.vertex_count());
  return sizeof(FastModel) + tool.memory_bytes() + rest.memory_bytes() + normals.memory_bytes() +
         skeleton.anchor_m.size() * (sizeof(scene::Vec3) + sizeof(double)) + vertices * 7 * sizeof(double) +
         surface.triangles.size() * sizeof(surface.triangles[0]);
}

}  // namespace touchstone::fast
