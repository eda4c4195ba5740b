// The comparison in sentences, every number and every reason taken from the figures.
#pragma once

#include "compare/errors/errors.h"
#include "compare/model/model.h"
#include "compare/report/next_steps.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <string>
#include <vector>

namespace touchstone::compare {

struct Verdict {
  std::string force, shape;     ///< the result with its numbers
  std::vector<Reason> reasons;  ///< what limits each side, the most important first
  std::vector<NextStep> next;

  /// For a terminal of 80 columns: what is brief, and the first two of the next steps.
  [[nodiscard]] std::string text() const;
};

/// For a reader who is new to both models. An error within the reference's uncertainty is called not distinguishable.
/// @param model  that the run is of
[[nodiscard]] Verdict verdict(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                              const Errors& errors, const Call& call, const ModelEntry& model);

/// The uncertainty of the reference's force and shape, and why its refinement ended.
[[nodiscard]] std::string reference_sentence(const reference::Result& result, const Errors& errors);

}  // namespace touchstone::compare
