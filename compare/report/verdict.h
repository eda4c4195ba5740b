// The comparison in sentences, every number and every reason taken from the figures.
#pragma once

#include "compare/errors/errors.h"
#include "compare/report/next_steps.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Hertz's force of a ball on the scene's box, ball or ellipsoid top [N]: 4/3 E/(1-nu^2) sqrt(R) depth^1.5, R the
/// effective radius; nothing for other tools and bodies, and with inclusions. For small depths and small strain; an
/// order of magnitude for the scene's material, not a reference.
[[nodiscard]] std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m);

/// One paragraph of an explanation.
struct Reason {
  std::string about;        ///< what it is about, "Force"
  std::string brief = {};   ///< for terminal and page; may be empty
  std::string detail = {};  ///< for the page alone; may be empty

  [[nodiscard]] std::string text() const;  ///< brief and detail
};

struct Verdict {
  std::string force, shape;     ///< the result with its numbers
  std::vector<Reason> reasons;  ///< what limits each side, the most important first
  std::vector<NextStep> next;

  /// For a terminal of 80 columns: what is brief, and the first two of the next steps.
  [[nodiscard]] std::string text() const;
};

/// For a reader who is new to both models. An error within the reference's uncertainty is called not distinguishable.
[[nodiscard]] Verdict verdict(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                              const Errors& errors, const Call& call);

/// The uncertainty of the reference's force and shape, and why its refinement ended.
[[nodiscard]] std::string reference_sentence(const reference::Result& result, const Errors& errors);

}  // namespace touchstone::compare
