// The result folder of `touchstone fast`: curve, beam ends, figures, manifest. The surface series needs VTK and
// is written by the full executable only.
#pragma once

#include "fast/run/run.h"
#include "scene/output/results.h"

#include <filesystem>

namespace touchstone::fast {

/// The fast.* keys of summary.json.
[[nodiscard]] scene::Figures figures(const Run& run);

/// Columns of beams.csv, a row per instant, pressing region and anchor point: the anchor point's rest place and
/// displacement and the beam's force F_i in the world frame, then the beam's axes x_i and y_i and all components of
/// stress and strain at its end in that frame (equations (7) to (9)).
[[nodiscard]] std::vector<scene::Column> beam_columns(const std::vector<BeamRecord>& beams);

/// Runs the scene with progress and writes curve.csv, beams.csv, summary.json and manifest.json into the folder.
/// @param manifest  command already filled in; this adds the stage times
Run run_into_folder(const scene::Scene& scene, const std::filesystem::path& folder, scene::Manifest manifest,
                    bool quiet);

/// A few lines for the terminal: deepest force, step time, status.
[[nodiscard]] std::string summary_text(const Run& run);

}  // namespace touchstone::fast
