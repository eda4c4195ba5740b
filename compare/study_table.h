// The cases of a study as one table, with what is missing and why.
#pragma once

#include "compare/study_run.h"

#include <string>

namespace touchstone::compare {

struct StudyTable {
  int cases = 0, done = 0;
  std::string text;  ///< for the terminal: what is not done, why, and the indices to run again
};

/// Merges the summaries into summary.csv, summary.json and summary.md in the study's folder: one row per case with its
/// place on every axis, its state, and every figure; what a case does not have is empty. Cases may be running.
/// @throws std::filesystem::filesystem_error
StudyTable collect(const StudyManifest& manifest);

/// Numbers as a batch system takes them: "1,3-5,9".
[[nodiscard]] std::string ranges_text(const std::vector<int>& ascending);

}  // namespace touchstone::compare
