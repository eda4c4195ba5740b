// The reference as the commands run it: progress on the terminal, Ctrl-C, its own figures and curve.
#pragma once

#include "reference/solver.h"
#include "scene/output/results.h"
#include "scene/shape/surface.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace touchstone::compare {

/// Limit of one solve that refines until an error is reached.
constexpr double default_minutes = 60.0;

/// Command-line options of a solve.
struct ReferenceOptions {
  std::filesystem::path store = "out/reference-store";  ///< content-addressed results, shared by all runs
  std::optional<int> levels = {};                       ///< in place of the scene's levels or error
  std::optional<double> error = {};                     ///< in place of the scene's levels or error
  std::optional<double> memory_gib = {};                ///< limit of one solve, as the next
  std::optional<double> minutes = {};  ///< absent: default_minutes, and no limit where a number of meshes is asked for
  bool volume = false;                 ///< also write the inside of the body
  std::optional<double> require_error = {};  ///< uncertainty of force and shape that the exit code depends on
};

/// The given options that affect the result, as typed: " --level 3 --minutes 20".
[[nodiscard]] std::string options_text(const ReferenceOptions& options);

/// The scene with the levels or the error that the command line asks for, and the store.
[[nodiscard]] scene::Scene asked(scene::Scene scene, const ReferenceOptions& options);

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
