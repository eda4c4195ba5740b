// The comparison in plain words, every number and every reason taken from the figures themselves.
#pragma once

#include "compare/errors.h"
#include "compare/next_steps.h"

#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Hertz's force of a ball on the scene's box, ball or ellipsoid top [N]: 4/3 E/(1-nu^2) sqrt(R) depth^1.5, R the
/// effective radius; nothing for other tools and bodies, and with inclusions. For small depths and small strain; an
/// order of magnitude for the scene's material, not a reference.
[[nodiscard]] std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m);

struct Verdict {
  std::string force, shape;          ///< with numbers, for who reads no further
  std::vector<std::string> reasons;  ///< paragraphs: what limits each side, the most important first
  std::vector<NextStep> next;

  /// For a terminal: wrapped, commands on lines of their own.
  [[nodiscard]] std::string text() const;
};

/// For a reader who knows neither model. An error within the reference's uncertainty is called not distinguishable.
[[nodiscard]] Verdict verdict(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                              const Errors& errors, const Call& call);

/// How well the reference knows its own force and shape, a sentence; why, where it does not.
[[nodiscard]] std::string reference_sentence(const reference::Result& result, const Errors& errors);

}  // namespace touchstone::compare
