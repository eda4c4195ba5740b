// What a force error costs: the reference and CalculiX on one problem over one sequence of meshes, in one run.
#pragma once

#include "reference/solver.h"
#include "scene/model/scene.h"
#include "scene/output/results.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// One code on one mesh, all load steps.
struct MeshCost {
  int level = 0;
  double error = 0.0;  ///< largest force error of all instants over the largest force
  double wall_s = 0.0, cpu_s = 0.0;
};

/// Cost of the first mesh from which on the error stays within a limit; nothing when the last mesh misses it.
[[nodiscard]] std::optional<MeshCost> cost_within(const std::vector<MeshCost>& meshes, double error);

struct TimeToError {
  std::vector<MeshCost> ours, calculix;
};

/// Solves levels 0 to meshes - 1 with both, and two finer levels of the reference that both are measured against.
/// Everything is solved anew, in the folder. A mesh on which CalculiX does not finish is left out.
/// @throws as calculix_deck, run_calculix and solve do
[[nodiscard]] TimeToError time_to_error(const scene::Scene& scene, int meshes, const std::filesystem::path& folder);

/// A table for people, with the ratio of CPU times at 1 % and 0.5 %.
[[nodiscard]] std::string time_to_error_text(const TimeToError& times);
[[nodiscard]] std::string time_to_error_svg(const TimeToError& times, const std::string& title);
[[nodiscard]] std::vector<scene::Column> time_to_error_columns(const TimeToError& times);

}  // namespace touchstone::compare
