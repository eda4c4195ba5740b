// From both sides' answers to a result folder: curve.csv, surface.pvd, shape.svg, summary.json, manifest.json,
// report.html.
#pragma once

#include "compare/errors/errors.h"
#include "compare/model/judge.h"
#include "compare/report/next_steps.h"
#include "fast/run/run.h"
#include "reference/run/inside.h"
#include "reference/solver.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>

namespace touchstone::compare {

/// Columns of curve.csv: time, tool pose and depth; both sides' regions (fast_..., reference_...); the reference's
/// uncertainty; errors per instant. A column that has no meaning at an instant holds nan there.
[[nodiscard]] std::vector<scene::Column> curve_columns(const fast::Run& run, const reference::Result& result,
                                                       const Errors& errors);

/// The text for the terminal once the folder is written.
struct Comparison {
  scene::Figures figures;  ///< what summary.json holds
  std::string text;        ///< the verdict, wrapped for a terminal
};

/// Compares and writes the whole folder, which must exist.
/// @param run         of the scene, by the fast model, which the page is about
/// @param contenders  all models that are judged by this answer of the reference
/// @param call    its options, and for the commands to type next; without a scene file there are none
/// @param inside  of the result, for the stress in the section; nullptr: not drawn
/// @throws std::logic_error when the sides do not belong together, std::filesystem::filesystem_error
Comparison write_comparison(const std::filesystem::path& folder, const scene::Scene& scene, const fast::Run& run,
                            const reference::Result& result, const scene::Manifest& manifest,
                            const Contenders& contenders, const Call& call = {},
                            const reference::Inside* inside = nullptr);

}  // namespace touchstone::compare
