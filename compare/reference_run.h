// The offline side as the verbs run it: progress on the terminal, Ctrl-C, its own figures and curve.
#pragma once

#include "reference/solver.h"
#include "scene/results.h"
#include "scene/surface.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace touchstone::compare {

/// What the command line says about a solve.
struct ReferenceOptions {
  std::filesystem::path store = "out/reference-store";  ///< content-addressed results, shared by all runs
  std::optional<int> levels;                            ///< in place of the scene's levels or error
  std::optional<double> error;                          ///< in place of the scene's levels or error
  std::optional<double> memory_gib;                     ///< limit of a refinement towards an error, as the next
  double minutes = 60.0;
};

/// What of it was said, as it is typed, " --level 3"; without the limits of memory and time, which may be another's.
[[nodiscard]] std::string options_text(const ReferenceOptions& options);

/// The scene with the levels or the error that the command line asks for.
[[nodiscard]] scene::Scene asked(scene::Scene scene, const ReferenceOptions& options);

/// Solves, resumes or reads back, showing every load step and Newton residual. Ctrl-C ends it after the current
/// Newton iteration with reference::Interrupted; a second Ctrl-C ends the process at once.
[[nodiscard]] reference::Result solve_with_progress(const scene::Scene& scene, const scene::Surface& surface,
                                                    const ReferenceOptions& options, bool quiet);

/// Runs a solve; its two ways of giving no answer become one message and the exit code that is returned.
[[nodiscard]] int with_reference_exits(const std::function<int()>& solve);

/// Writes curve.csv, summary.json and manifest.json of the reference alone.
/// @throws std::filesystem::filesystem_error
void write_reference(const std::filesystem::path& folder, const reference::Result& result,
                     const scene::Manifest& manifest);

/// A few lines for the terminal: force with its uncertainty, model, cost.
[[nodiscard]] std::string reference_text(const reference::Result& result);

}  // namespace touchstone::compare
