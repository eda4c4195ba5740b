#include "compare/ceilings.h"

#include "compare/text.h"

#include <fmt/format.h>

namespace touchstone::compare {
namespace {

/// "12 %, within the 10 to 35 % expected".
std::string placed_text(const Measure& error, const Expected& expected) {
  if (!error.value) return "unknown";
  return fmt::format("{}, {} the {} to {} expected", percent_text(*error.value), against(error, expected),
                     number_text(100.0 * expected.low), percent_text(expected.high));
}

}  // namespace

Expected expected_force(scene::ContactLaw law, bool held_out) {
  if (law == scene::ContactLaw::area_aware) return held_out ? Expected{0.007, 0.03} : Expected{0.0, 0.002};
  return held_out ? Expected{0.10, 0.35} : Expected{0.015, 0.025};
}

std::string_view against(const Measure& error, const Expected& expected) {
  if (!error.value) return "";
  const double band = error.uncertainty.value_or(0.0);
  if (*error.value + band < expected.low) return "below";
  return *error.value - band <= expected.high ? "within" : "above";
}

bool has_ceiling(const scene::Scene& scene) { return !scene.contact.friction; }

std::string ceiling_sentence(const Tuning& tuning, const TunedModel& model, const TuningOutcome& outcome) {
  const scene::TuningContact& contact = tuning.data[outcome.data].contact;
  const bool held_out = tuning.data[outcome.data].held_out();
  std::string text = contact.name + (held_out ? " (held out): " : " (training): ");
  if (!has_ceiling(contact.scene)) return text + "nothing to compare with, the prototype had no friction.";
  const Errors& e = outcome.errors;
  const Expected force = expected_force(model.law, held_out);
  text += "force " + placed_text(e.force_nrmse, force) + "; shape " + placed_text(e.shape_rel_l2, expected_shape) + ".";
  const bool force_below = against(e.force_nrmse, force) == "below";
  const bool shape_below = against(e.shape_rel_l2, expected_shape) == "below";
  if (force_below || shape_below) {
    text += force_below && shape_below ? " A force and a shape error lower than the ceiling need an explanation."
                                       : fmt::format(" A {} error lower than the ceiling needs an explanation.",
                                                     force_below ? "force" : "shape");
  }
  if (shape_below && &outcome == &model.outcomes.front()) {
    text +=
        fmt::format(" Without the local factor the shape would be {} off: the prototype's R stayed near the contact.",
                    percent_text(model.shape_parts.without_local_factor));
  }
  if (against(e.shape_rel_l2, expected_exact_anchors) == "below") {
    text += fmt::format(" The shape is even below the {} to {} that exact anchor points would leave.",
                        number_text(100.0 * expected_exact_anchors.low), percent_text(expected_exact_anchors.high));
  }
  return text;
}

}  // namespace touchstone::compare
