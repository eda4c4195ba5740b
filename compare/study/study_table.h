// The cases of a study as one table, with what is missing and why.
#pragma once

#include "compare/study/study_run.h"
#include "scene/model/answer.h"

#include <string>

namespace touchstone::compare {

struct StudyTable {
  int cases = 0, done = 0;
  std::string text;  ///< for the terminal: what is not done, why, and the indices to run again
};

/// Merges the summaries into summary.csv, summary.json, summary.md and report.html in the study's folder: one row per
/// case with its place on every axis, its state, and every figure. What a case does not have is empty; a number that is
/// not known is nan, in JSON null. Cases may be running.
/// @throws scene::InputError when a case's scene or summary cannot be read, std::filesystem::filesystem_error
StudyTable collect(const StudyManifest& manifest);

/// Numbers as a batch system takes them: "1,3-5,9".
[[nodiscard]] std::string ranges_text(const std::vector<int>& ascending);

}  // namespace touchstone::compare
