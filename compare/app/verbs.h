// The commands of `touchstone`: load a scene, refuse what cannot be done before any work, run, write, report.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

#include <filesystem>

namespace touchstone::compare {

/// @returns exit code; @throws scene::InputError for bad input
int plan(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_reference(const fast::VerbOptions& options, const ReferenceOptions& reference);
/// @param parameters  file that `tune` leaves, or empty; for the fast side alone, the reference keeps the scene's own
/// @param plots  also every plot of the report as files
int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference,
                const std::filesystem::path& parameters, bool plots = false);

}  // namespace touchstone::compare
