// What a tuned model can be expected to reach, as a prototype measured it: a lower error is a bug until explained.
#pragma once

#include "compare/tune.h"

#include <string>
#include <string_view>

namespace touchstone::compare {

/// Range in which an error is expected, relative.
struct Expected {
  double low = 0.0, high = 0.0;
};

/// Force error of the peak (force.nrmse) of a law tuned on one contact, there or held out. Measured under balls of 5 to
/// 15 mm, pins and capsules on a rubber cube, balls and spheroids, without friction.
[[nodiscard]] Expected expected_force(scene::ContactLaw law, bool held_out);

/// Shape error (shape.rel_l2) of a skeleton that moves the surface by the body's anchor points and a local factor.
inline constexpr Expected expected_shape{0.65, 0.80};
/// What exact displacements of the anchor points would leave of it.
inline constexpr Expected expected_exact_anchors{0.40, 0.60};

/// "below", "within" or "above" the range; below and above only where the reference's uncertainty does not reach into
/// it, "" without a value. What is not finite is above.
[[nodiscard]] std::string_view against(const Measure& error, const Expected& expected);

/// Whether the prototype says anything about such a contact: it had no friction.
[[nodiscard]] bool has_ceiling(const scene::Scene& scene);

/// One contact's force and shape error against what is expected of them, in a sentence or two.
[[nodiscard]] std::string ceiling_sentence(const Tuning& tuning, const TunedModel& model, const TuningOutcome& outcome);

}  // namespace touchstone::compare
