#include "fast/response/checked_range.h"

#include "scene/response/find_tips.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace touchstone::fast {

CheckedRange checked_range(const scene::Scene& scene) {
  constexpr double flat = 1e-3;  // round-off of a plane's curvature
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const bool incompressible = scene.body.material.poissons_ratio == 0.5;
  CheckedRange out = incompressible ? CheckedRange{.depth_over_radius = 0.82,
                                                   .size_rel = 0.24,
                                                   .edge_over_radius = 1.6,
                                                   .apart_over_radii = 6.0,
                                                   .curvature_rel = 0.67,
                                                   .depth_curvature = 0.27}
                                    : CheckedRange{.depth_over_radius = 0.7,
                                                   .size_rel = 0.22,
                                                   .edge_over_radius = 2.4,
                                                   .apart_over_radii = infinite,
                                                   .curvature_rel = flat,
                                                   .depth_curvature = 0.27};
  if (scene.contact.friction) out.curvature_rel = flat;
  const std::vector<scene::ToolTip> tips = scene::tool_tips(scene).tips;
  const bool balls = std::all_of(tips.begin(), tips.end(), [](const auto& tip) { return tip.ball() && !tip.line(); });
  if (!incompressible && (scene.contact.friction || !balls)) out.scene |= StepStatus::material_unchecked;
  if (!scene.body.inclusions.empty()) out.scene |= StepStatus::inclusion_unchecked;
  return out;
}

std::string_view pressure_errors(const scene::Scene& scene) {
  const std::vector<scene::ToolTip> tips = scene::tool_tips(scene).tips;
  if (!scene.body.inclusions.empty()) return "NOT GOOD above a soft inclusion, up to 50 % off";
  if (tips.size() > 1) return "5 % off under two pins";
  if (tips.front().line()) return "4 % off under a capsule's side, 9 % near an edge";
  if (!tips.front().ball()) return "5 % off under a pin, NOT GOOD under a wide disc with a narrow rim, 35 %";
  if (scene.contact.friction) return "7 % off on a flat face, 20 % on a curved one, with friction";
  return "3 to 4 % off under a ball, up to 9 % near an edge";
}

StepStatus beyond(const CheckedRange& checked, const ContactRange& range) noexcept {
  StepStatus status = checked.scene;
  if (range.depth_over_radius > checked.depth_over_radius ||
      range.depth_over_radius * range.curvature_rel > checked.depth_curvature) {
    status |= StepStatus::depth_unchecked;
  }
  if (range.size_rel > checked.size_rel) status |= StepStatus::size_unchecked;
  if (range.edge_over_radius < checked.edge_over_radius) status |= StepStatus::edge_unchecked;
  if (range.apart_over_radii < checked.apart_over_radii) status |= StepStatus::regions_unchecked;
  if (range.curvature_rel > checked.curvature_rel) status |= StepStatus::curvature_unchecked;
  return status;
}

}  // namespace touchstone::fast
