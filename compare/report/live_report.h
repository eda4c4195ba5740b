// The page of a live run.
#pragma once

#include "fast/live/live.h"
#include "scene/model/scene.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>

namespace touchstone::compare {

/// The page as well-formed XHTML: numbers, force over time and lateness first; then faults in words, missed ticks, the
/// time of a tick and of its stages, settings and manifest.
[[nodiscard]] std::string live_report_html(const scene::Scene& scene, const live::LiveOptions& options,
                                           const live::LiveResult& result, const scene::Manifest& manifest);

/// Writes report.html into the folder. @returns its path; @throws std::filesystem::filesystem_error
std::filesystem::path write_live_report(const std::filesystem::path& folder, const scene::Scene& scene,
                                        const live::LiveOptions& options, const live::LiveResult& result,
                                        const scene::Manifest& manifest);

}  // namespace touchstone::compare
