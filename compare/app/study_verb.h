// `study expand|run|collect`.
#pragma once

#include "compare/solve/reference_options.h"
#include "fast/command/command_line.h"

#include <filesystem>

namespace touchstone::compare {

struct StudyOptions {
  std::filesystem::path study;   ///< expand: the study file; run, collect: the study's folder
  std::filesystem::path out;     ///< expand: the folder; empty: `out/<study>-study`
  ReferenceOptions reference{};  ///< of these only the store
  int index = 0;                 ///< 0: all cases
  int step = 0;                  ///< 0: the one case
  bool quiet = false;
};

/// Adds the command; its variables must outlive Program::run.
void add_study_verb(fast::Command& program, StudyOptions& options);

}  // namespace touchstone::compare
