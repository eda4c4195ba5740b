// `tune STUDY`.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

#include <filesystem>

namespace touchstone::compare {

struct TuneOptions {
  std::filesystem::path study;
  std::filesystem::path out;  ///< empty: out/<study>-tune
  bool quiet = false;
};

/// Adds the verb to a command line. All three must outlive the parse.
/// @param reference  its options are the caller's to add
CLI::App* add_tune_verb(CLI::App& app, TuneOptions& options, ReferenceOptions& reference, int& exit_code);

}  // namespace touchstone::compare
