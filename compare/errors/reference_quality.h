// How far one reference result can be trusted, in a few figures.
#pragma once

#include "reference/run/uncertainty.h"
#include "reference/solver.h"
#include "scene/output/results.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

using reference::deep_instants;
using reference::deep_share;
using reference::grazing_depth_m;

/// The largest over the deep instants, absent where there is none.
struct ReferenceQuality {
  std::optional<double> force_uncertainty_rel;     ///< uncertainty / |F|
  std::optional<double> residual_penetration_rel;  ///< into the tool at contact nodes, / depth
  std::optional<double> between_nodes_rel;         ///< into the tool between contact nodes, / depth
  std::optional<double> equilibrium_rel;           ///< |contact + support| / |contact|
  double volume_change_rel = 0.0;                  ///< of the body, of the largest magnitude over all instants, signed
  double pressure_peak_pa = 0.0;                   ///< largest over the deep instants
  std::optional<double> pressure_peak_uncertainty_rel;
  Eigen::Vector2d contact_half_axes_m = Eigen::Vector2d::Zero();  ///< where the long one is largest
  std::array<std::optional<double>, 2> contact_half_axes_uncertainty_rel;
};
[[nodiscard]] ReferenceQuality reference_quality(const std::vector<scene::ReferenceInstant>& instants);

/// The reference.* keys of summary.json that need no other side.
[[nodiscard]] scene::Figures reference_figures(const reference::Result& result, const ReferenceQuality& quality);

/// The same per instant, as columns of curve.csv: uncertainty, largest pressure, half axes of the contact, penetration,
/// equilibrium, volume, the force on every level.
[[nodiscard]] std::vector<scene::Column> reference_quality_columns(const reference::Result& result,
                                                                   const std::string& prefix);

}  // namespace touchstone::compare
