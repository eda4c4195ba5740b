// The commands of `touchstone`: load a scene, refuse what cannot be done before any work, run, write, report.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// @returns exit code; @throws scene::InputError for bad input
int plan(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_reference(const fast::VerbOptions& options, const ReferenceOptions& reference);

struct CompareOptions {
  std::filesystem::path
      parameters{};                   ///< that `tune` leaves, or empty; for the models, the reference keeps the scene's
  std::vector<std::string> models{};  ///< keys of further ones, for the table
  bool plots = false;                 ///< also every plot of the report as files
};
int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference, const CompareOptions& more = {});

}  // namespace touchstone::compare
