// The reference as the commands run it: progress on the terminal, Ctrl-C, its own figures and curve.
#pragma once

#include "compare/solve/reference_options.h"
#include "reference/solver.h"
#include "scene/output/results.h"
#include "scene/shape/surface.h"

#include <filesystem>
#include <functional>
#include <string>

namespace touchstone::compare {

/// @throws scene::InputError with what of the scene the reference cannot do
void refuse_unsupported(const scene::Scene& scene);

/// One line for the terminal, the most important first.
[[nodiscard]] std::string progress_text(const reference::Progress& progress);

/// Solves, resumes or reads back, and shows the progress. Ctrl-C, SIGTERM or SIGHUP
/// ends it after the current Newton iteration with reference::Interrupted; a second one ends the process at once.
[[nodiscard]] reference::Result solve_with_progress(const scene::Scene& scene, const scene::Surface& surface,
                                                    const ReferenceOptions& options, bool quiet);

/// Runs a solve; where it gives no answer, prints one message and returns the exit code.
[[nodiscard]] int with_reference_exits(const std::function<int()>& solve);

/// Writes curve.csv, summary.json and manifest.json of the reference alone.
/// @throws std::filesystem::filesystem_error
void write_reference(const std::filesystem::path& folder, const reference::Result& result,
                     const scene::Manifest& manifest);

/// A few lines for the terminal: force with its uncertainty, model, cost, and the next.
[[nodiscard]] std::string reference_text(const reference::Result& result);

/// Two lines for the terminal: the uncertainty of the result, and why refinement ended.
[[nodiscard]] std::string refinement_text(const reference::Result& result);

/// Whether the uncertainties of force and shape are known and at most this.
[[nodiscard]] bool known_to(const reference::Result& result, double error);

/// The exit code of a command whose results are written, with a sentence on stderr where --require-error is missed.
[[nodiscard]] int exit_of(const reference::Result& result, const ReferenceOptions& options);

}  // namespace touchstone::compare
