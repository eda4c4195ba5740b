#include "compare/reference_quality.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace touchstone::compare {
namespace {

/// Keeps the larger; once NaN, stays NaN, so that no bad number is lost in a maximum.
void keep_larger(std::optional<double>& largest, double value) {
  if (!largest || std::isnan(value) || value > *largest) largest = value;
}

scene::Figure ratio_or_why(const std::string& key, const std::optional<double>& value) {
  if (!value) return {key, 0.0, "undefined: the reference is never in contact", ""};
  if (std::isinf(*value)) return {key, 0.0, "unknown", ""};
  return {key, *value, "", ""};
}

}  // namespace

std::vector<bool> deep_instants(const std::vector<scene::InstantRecord>& instants) {
  double deepest_m = 0.0;
  for (const scene::InstantRecord& instant : instants) deepest_m = std::max(deepest_m, instant.depth_m);
  std::vector<bool> deep;
  for (const scene::InstantRecord& instant : instants) {
    deep.push_back(instant.depth_m > grazing_depth_m && instant.depth_m > deep_share * deepest_m);
  }
  return deep;
}

ReferenceQuality reference_quality(const reference::Result& result) {
  ReferenceQuality quality;
  const std::vector<bool> deep = deep_instants(result.instants);
  for (std::size_t t = 0; t < result.instants.size(); ++t) {
    const double volume_change_rel = result.volume_change_rel[t];
    if (std::isnan(volume_change_rel) || std::abs(volume_change_rel) > std::abs(quality.volume_change_rel)) {
      quality.volume_change_rel = volume_change_rel;
    }
    if (!deep[t]) continue;
    const double depth_m = result.instants[t].depth_m, force_n = result.instants[t].force_n().norm();
    if (force_n > 0.0) keep_larger(quality.force_uncertainty_rel, result.force_uncertainty_n[t] / force_n);
    keep_larger(quality.residual_penetration_rel, result.residual_penetration_m[t] / depth_m);
    keep_larger(quality.between_nodes_rel, result.between_nodes_penetration_m[t] / depth_m);
    keep_larger(quality.equilibrium_rel, result.equilibrium_rel[t]);
  }
  return quality;
}

scene::Figures reference_figures(const reference::Result& result, const ReferenceQuality& quality) {
  const double wall_s = std::accumulate(result.levels.begin(), result.levels.end(), 0.0,
                                        [](double sum, const auto& level) { return sum + level.wall_s; });
  return {
      ratio_or_why("reference.force_uncertainty_rel", quality.force_uncertainty_rel),
      ratio_or_why("reference.residual_penetration_rel", quality.residual_penetration_rel),
      ratio_or_why("reference.penetration_between_nodes_rel", quality.between_nodes_rel),
      ratio_or_why("reference.equilibrium_rel", quality.equilibrium_rel),
      {"reference.volume_change_rel", quality.volume_change_rel, "", ""},
      {"reference.dofs", result.levels.empty() ? 0.0 : result.levels.back().unknowns, "", ""},
      {"reference.wall_s", wall_s, "", "s"},
      {"reference.model", 0.0, result.model, ""},
  };
}

std::vector<scene::Column> reference_quality_columns(const reference::Result& result, const std::string& prefix) {
  return {
      {prefix + "force_uncertainty_n", result.force_uncertainty_n},
      {prefix + "residual_penetration_m", result.residual_penetration_m},
      {prefix + "between_nodes_penetration_m", result.between_nodes_penetration_m},
      {prefix + "equilibrium_rel", result.equilibrium_rel},
      {prefix + "volume_change_rel", result.volume_change_rel},
  };
}

}  // namespace touchstone::compare
