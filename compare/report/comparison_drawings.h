// Every drawing of a comparison, made once: for the report's page and for files of their own.
#pragma once

#include "compare/errors/errors.h"
#include "compare/format/svg_plot.h"
#include "compare/report/fast_drawings.h"
#include "fast/run/run.h"
#include "reference/run/inside.h"
#include "reference/solver.h"

#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

struct ComparisonDrawings {
  Drawing force;                ///< both sides over depth, over time where the depth does not only grow
  Drawing shape_error;          ///< over the same
  std::vector<Drawing> forces;  ///< further ones: over the other axis, logarithmic, friction, relative error
  std::vector<Drawing> shapes;  ///< further ones: sections, largest error
  std::vector<Drawing> bodies;  ///< half-cut in space: "reference", "fast" and "error"
  std::string bodies_in_a_row;  ///< the same as one `<svg>` element

  /// For files.
  [[nodiscard]] std::vector<Drawing> all() const;

  /// Every name that a drawing of all() can have.
  [[nodiscard]] static const std::vector<std::string>& names();
};

/// @param inside  of the result, for the stress in the section; nullptr: not drawn
[[nodiscard]] ComparisonDrawings comparison_drawings(const scene::Scene& scene, const fast::Run& run,
                                                     const reference::Result& result, const Errors& errors,
                                                     const reference::Inside* inside = nullptr);

/// Force of both solvers with the reference's uncertainty, over depth or, where that does not only grow, over time.
[[nodiscard]] Plot force_plot(const Errors& errors);

/// Largest uncertainty of the reference's force relative to it; nothing where it is unknown at an instant of contact.
[[nodiscard]] std::optional<double> force_known_to(const Errors& errors);

/// Why the reference's uncertainty is unknown and why its refinement ended, in sentences.
[[nodiscard]] std::string why_uncertainty_unknown(const reference::Result& result);

/// Where sliding begins on each side, a sentence.
[[nodiscard]] std::string slip_text(const Errors& errors);

}  // namespace touchstone::compare
