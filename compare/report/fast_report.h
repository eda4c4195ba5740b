// What `touchstone fast` computed, as a page and as one SVG file per drawing.
#pragma once

#include "fast/run/run.h"
#include "scene/model/scene.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>

namespace touchstone::compare {

/// The page as well-formed XHTML: force, shape, figures, plan and manifest; no more of it than the scene has.
[[nodiscard]] std::string fast_report_html(const scene::Scene& scene, const fast::Run& run,
                                           const scene::Manifest& manifest);

/// Writes report.html and the drawings; removes drawings an earlier run left that this one has not.
/// @throws std::filesystem::filesystem_error
void write_fast_report(const std::filesystem::path& folder, const scene::Scene& scene, const fast::Run& run,
                       const scene::Manifest& manifest);

}  // namespace touchstone::compare
