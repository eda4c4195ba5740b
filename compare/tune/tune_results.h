// The result files of a tuning.
#pragma once

#include "compare/tune/tuning.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>

namespace touchstone::compare {

/// Keys of summary.json: of a comparison under training. and held_out., the worst of the contacts, with
/// `training.<contact>.` and `held_out.<contact>.` for each; the parameters and what is known of them.
/// All of the first model; of every model again behind its name.
[[nodiscard]] scene::Figures tuning_figures(const Tuning& tuning);

/// The model's values as a file that a scene can include.
[[nodiscard]] std::string parameters_toml(const Tuning& tuning, const TunedModel& model);

/// parameters.toml of the first model, `parameters-<formulation>-<law>.toml` of each, summary.json, curve.csv,
/// report.html and manifest.json. @throws std::filesystem::filesystem_error
void write_tuning(const std::filesystem::path& folder, const Tuning& tuning, const scene::Manifest& manifest);

}  // namespace touchstone::compare
