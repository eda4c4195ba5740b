// `touchstone prepare`: the response of a scene's body, computed once and kept in the store.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

namespace touchstone::compare {

/// Adds the command; its variables must outlive Program::run.
void add_prepare_verb(fast::Command& program, fast::VerbOptions& options, ReferenceOptions& reference);

}  // namespace touchstone::compare
