// The verbs of `touchstone`: load a scene, refuse what cannot be done before any work, run, write, say.
#pragma once

#include "fast/command_line.h"

#include <filesystem>

namespace touchstone::compare {

/// @param store folder of content-addressed reference results
/// @returns exit code; @throws scene::InputError for bad input
int plan(const fast::VerbOptions& options, const std::filesystem::path& store);
int run_fast(const fast::VerbOptions& options, const std::filesystem::path& store);
int run_reference(const fast::VerbOptions& options, const std::filesystem::path& store);
int run_compare(const fast::VerbOptions& options, const std::filesystem::path& store);

}  // namespace touchstone::compare
