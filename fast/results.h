// The result folder of `touchstone fast`: curve, figures, manifest. The surface series needs VTK and
// is written by the full executable only.
#pragma once

#include "fast/run.h"
#include "scene/results.h"

#include <filesystem>

namespace touchstone::fast {

/// The fast.* keys of summary.json.
[[nodiscard]] scene::Figures figures(const Run& run);

/// Runs the scene with progress and writes curve.csv, summary.json and manifest.json into the folder.
/// @param manifest  command already filled in; this adds the stage times
Run run_into_folder(const scene::Scene& scene, const std::filesystem::path& folder, scene::Manifest manifest,
                    bool quiet);

/// A few lines for the terminal: deepest force, step time, status.
[[nodiscard]] std::string summary_text(const Run& run);

}  // namespace touchstone::fast
