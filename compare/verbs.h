// The verbs of `touchstone`: load a scene, refuse what cannot be done before any work, run, write, say.
#pragma once

#include "compare/reference_run.h"
#include "fast/command_line.h"

namespace touchstone::compare {

/// @returns exit code; @throws scene::InputError for bad input
int plan(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_reference(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference);

}  // namespace touchstone::compare
