// `tune STUDY`.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

#include <filesystem>

namespace touchstone::compare {

struct TuneOptions {
  std::filesystem::path study;
  std::filesystem::path out;  ///< empty: `out/<study>-tune`
  bool quiet = false;
};

/// Adds the command; its variables must outlive Program::run.
void add_tune_verb(fast::Command& program, TuneOptions& options, ReferenceOptions& reference);

}  // namespace touchstone::compare
