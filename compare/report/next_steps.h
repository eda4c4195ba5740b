// The next commands for this scene, each tried with the fast model against the reference at hand where
// that can be tried.
#pragma once

#include "compare/errors/errors.h"
#include "compare/model/model.h"
#include "compare/report/call.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <string>
#include <vector>

namespace touchstone::compare {

struct NextStep {
  std::string why;      ///< a sentence or two
  std::string command;  ///< may be empty: nothing to type
  /// A file that the command reads, to be written into the result folder; no name: none.
  std::string file_name = {}, file_text = {};
};

/// The most important first; empty where nothing is left to do, and without a scene file.
/// @param model  that the run is of
[[nodiscard]] std::vector<NextStep> next_steps(const scene::Scene& scene, const fast::Run& run,
                                               const reference::Result& result, const Errors& errors, const Call& call,
                                               const ModelEntry& model);

}  // namespace touchstone::compare
