// The offline side as the verbs run it: progress on the terminal, Ctrl-C, its own figures and curve.
#pragma once

#include "reference/solver.h"
#include "scene/results.h"

#include <filesystem>
#include <functional>

namespace touchstone::compare {

/// Solves, resumes or reads back, showing every load step and Newton residual. Ctrl-C ends it after the current
/// Newton iteration with reference::Interrupted; a second Ctrl-C ends the process at once.
[[nodiscard]] reference::Result solve_with_progress(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m,
                                                    const std::filesystem::path& store, bool quiet);

/// Runs a solve; its two ways of giving no answer become one message and the exit code that is returned.
[[nodiscard]] int with_reference_exits(const std::function<int()>& solve);

/// Writes curve.csv, summary.json and manifest.json of the reference alone.
/// @throws std::filesystem::filesystem_error
void write_reference(const std::filesystem::path& folder, const reference::Result& result,
                     const scene::Manifest& manifest);

/// A few lines for the terminal: force with its uncertainty, model, cost.
[[nodiscard]] std::string reference_text(const reference::Result& result);

}  // namespace touchstone::compare
