// The commands about one scene: load it, refuse what cannot be done before any work, run, write, report.
#pragma once

#include "compare/report/call.h"
#include "fast/command/command_line.h"

namespace touchstone::compare {

/// @returns exit code; @throws scene::InputError for bad input
int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_reference(const fast::VerbOptions& options, const ReferenceOptions& reference);
int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference, const CompareOptions& more = {});

/// Adds `plan`, `fast`, `reference` and `compare`; their variables must outlive Program::run.
void add_scene_verbs(fast::Command& program, fast::VerbOptions& options, ReferenceOptions& reference,
                     CompareOptions& more);

}  // namespace touchstone::compare
