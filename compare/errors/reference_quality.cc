#include "compare/errors/reference_quality.h"

#include "compare/errors/measure.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace touchstone::compare {
namespace {

scene::Figure ratio_or_why(const std::string& key, const std::optional<double>& value) {
  if (!value) return {key, NAN, "undefined: the reference is never in contact", ""};
  return {key, *value, "", ""};
}

scene::Figure uncertainty_or_why(const std::string& key, const std::optional<double>& value) {
  if (value && !std::isfinite(*value)) return {key, NAN, "unknown", ""};
  return ratio_or_why(key, value);
}

}  // namespace

ReferenceQuality reference_quality(const std::vector<scene::ReferenceInstant>& instants) {
  ReferenceQuality quality;
  const std::vector<bool> deep = deep_instants(instants);
  quality.force_uncertainty_rel = reference::force_uncertainty_rel(instants);
  for (std::size_t t = 0; t < instants.size(); ++t) {
    const scene::ReferenceInstant& instant = instants[t];
    if (std::isnan(instant.volume_change_rel) ||
        std::abs(instant.volume_change_rel) > std::abs(quality.volume_change_rel)) {
      quality.volume_change_rel = instant.volume_change_rel;
    }
    if (!deep[t]) continue;
    if (instant.pressure_peak_pa > quality.pressure_peak_pa) {
      quality.pressure_peak_pa = instant.pressure_peak_pa;
      quality.pressure_peak_uncertainty_rel = instant.pressure_peak_uncertainty_pa / instant.pressure_peak_pa;
    }
    if (instant.contact_half_axes_m[0] > quality.contact_half_axes_m[0]) {
      quality.contact_half_axes_m = instant.contact_half_axes_m;
      for (int axis = 0; axis < 2; ++axis) {
        quality.contact_half_axes_uncertainty_rel[axis] =
            instant.contact_half_axes_uncertainty_m[axis] / instant.contact_half_axes_m[axis];
      }
    }
    keep_larger(quality.residual_penetration_rel, instant.residual_penetration_m / instant.depth_m);
    keep_larger(quality.between_nodes_rel, instant.between_nodes_penetration_m / instant.depth_m);
    keep_larger(quality.equilibrium_rel, instant.equilibrium_rel);
  }
  return quality;
}

scene::Figures reference_figures(const reference::Result& result, const ReferenceQuality& quality) {
  double wall_s = 0.0, cpu_s = 0.0, newton_iterations = 0.0;
  for (const reference::LevelRecord& level : result.levels) {
    wall_s += level.wall_s;
    cpu_s += level.cpu_s;
    newton_iterations += level.newton_iterations;
  }
  scene::Figures figures{
      uncertainty_or_why("reference.force_uncertainty_rel", quality.force_uncertainty_rel),
      uncertainty_or_why("reference.shape_uncertainty_rel", result.shape_uncertainty_rel),
      {"reference.pressure_peak_pa", quality.pressure_peak_pa, "", "Pa"},
      uncertainty_or_why("reference.pressure_peak_uncertainty_rel", quality.pressure_peak_uncertainty_rel),
      {"reference.contact_long_half_axis_m", quality.contact_half_axes_m[0], "", "m"},
      uncertainty_or_why("reference.contact_long_half_axis_uncertainty_rel",
                         quality.contact_half_axes_uncertainty_rel[0]),
      {"reference.contact_short_half_axis_m", quality.contact_half_axes_m[1], "", "m"},
      uncertainty_or_why("reference.contact_short_half_axis_uncertainty_rel",
                         quality.contact_half_axes_uncertainty_rel[1]),
      ratio_or_why("reference.residual_penetration_rel", quality.residual_penetration_rel),
      ratio_or_why("reference.penetration_between_nodes_rel", quality.between_nodes_rel),
      ratio_or_why("reference.equilibrium_rel", quality.equilibrium_rel),
      {"reference.volume_change_rel", quality.volume_change_rel, "", ""},
      {"reference.dofs", result.levels.empty() ? 0.0 : result.levels.back().unknowns, "", ""},
      {"reference.levels", static_cast<double>(result.levels.size()), "", ""},
      {"reference.newton_iterations", newton_iterations, "", ""},
      {"reference.wall_s", wall_s, "", "s"},
      {"reference.cpu_s", cpu_s, "", "s"},
      {"reference.model", 0.0, result.model, ""},
  };
  if (result.refinement.error_asked > 0.0) {
    figures.push_back({"reference.error_asked", result.refinement.error_asked, "", ""});
  }
  figures.push_back({"reference.why_ended", 0.0, result.refinement.why_ended, ""});
  for (const reference::Sensitivity& one : result.sensitivities) {
    const std::string key = "reference.sensitivity." + one.part;
    figures.push_back({key + "_force_rel", one.force_rel, "", ""});
    figures.push_back({key + "_shape_rel", one.shape_rel, "", ""});
  }
  return figures;
}

std::vector<scene::Column> reference_quality_columns(const reference::Result& result, const std::string& prefix) {
  using Instant = scene::ReferenceInstant;
  std::vector<scene::Column> columns;
  const auto add_values = [&](const char* name, const auto& value_of) {
    std::vector<double>& values = columns.emplace_back(scene::Column{prefix + name, {}}).values;
    for (const Instant& instant : result.instants) values.push_back(value_of(instant));
  };
  const auto add = [&](const char* name, double Instant::*member) {
    add_values(name, [&](const Instant& instant) { return instant.*member; });
  };
  add("force_uncertainty_n", &Instant::force_uncertainty_n);
  add("pressure_peak_pa", &Instant::pressure_peak_pa);
  add("pressure_peak_uncertainty_pa", &Instant::pressure_peak_uncertainty_pa);
  add_values("contact_long_half_axis_m", [](const Instant& i) { return i.contact_half_axes_m[0]; });
  add_values("contact_long_half_axis_uncertainty_m",
             [](const Instant& i) { return i.contact_half_axes_uncertainty_m[0]; });
  add_values("contact_short_half_axis_m", [](const Instant& i) { return i.contact_half_axes_m[1]; });
  add_values("contact_short_half_axis_uncertainty_m",
             [](const Instant& i) { return i.contact_half_axes_uncertainty_m[1]; });
  add("residual_penetration_m", &Instant::residual_penetration_m);
  add("between_nodes_penetration_m", &Instant::between_nodes_penetration_m);
  add("equilibrium_rel", &Instant::equilibrium_rel);
  add("volume_change_rel", &Instant::volume_change_rel);
  for (std::size_t level = 0; level < result.levels.size(); ++level) {
    columns.push_back({prefix + "force_level" + std::to_string(level + 1) + "_n", result.levels[level].force_n});
  }
  return columns;
}

}  // namespace touchstone::compare
