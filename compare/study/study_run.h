// Running the cases of a study: by index, by as many processes as there are, repeatedly.
//
// A case's result folder holds, in addition to the command's files: `lock`, held by the process that runs it;
// attempt.json, who began last; failed.json, why it failed; done.json, written when all else is on the disk, with the
// checksum of summary.json. A case is done when that is right; everything else is done again, and the reference's
// finished load steps come from its store.
#pragma once

#include "compare/study/study.h"
#include "scene/output/figures.h"

#include <functional>
#include <string>

namespace touchstone::compare {

enum class CaseState { done, failed, running, interrupted, waiting };
[[nodiscard]] const char* state_name(CaseState state);

struct CaseStatus {
  CaseState state = CaseState::waiting;
  std::string why;      ///< failed: the message; interrupted or running: who began, and when
  std::string version;  ///< done: of the program
  double wall_s = 0.0;  ///< done: of the run that finished it
};
[[nodiscard]] CaseStatus case_status(const StudyManifest& manifest, const ManifestCase& one);

/// One case with what it left.
struct StudyRow {
  const ManifestCase* one = nullptr;  ///< of the manifest
  CaseStatus status;
  scene::Figures figures;  ///< of its summary.json where it is done
};

/// Runs one scene file into a prepared folder as the command of that name does. Messages go to std::cerr.
/// @returns the command's exit code; may throw what the command throws
using CaseRun = std::function<int(const std::filesystem::path& scene_file, const std::filesystem::path& folder)>;

/// Which cases to run: from `first` on in steps of `step`.
struct CaseRange {
  int first = 1;
  int step = 1;
};

/// Runs what is not done of the range, then waits for the cases that other processes run.
/// @param say  called with one line about every case
/// @returns 0 when all are done; of one case its exit code, of several 1 when any failed; fast::interrupted at once
/// when
///          a run was stopped
/// @throws scene::InputError when the range is outside the study
int run_cases(const StudyManifest& manifest, const CaseRange& range, const CaseRun& run,
              const std::function<void(const std::string&)>& say);

}  // namespace touchstone::compare
