#include "compare/tune/findings.h"

#include "compare/format/text.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace touchstone::compare {
namespace {

std::string value_text(double value, const std::string& unit) {
  return number_text(value) + (unit.empty() ? "" : std::string(no_break) + unit);
}

/// Forces of the reference and of the model at a depth while the depth grows, interpolated between instants; nothing if
/// it is never reached.
std::optional<std::array<double, 2>> forces_at_n(const TuningOutcome& outcome, double depth_m) {
  const std::vector<InstantErrors>& e = outcome.errors.instants;
  for (std::size_t t = 1; t < e.size(); ++t) {
    if (e[t - 1].depth_m > depth_m || e[t].depth_m < depth_m || e[t].depth_m <= e[t - 1].depth_m) continue;
    const double share = (depth_m - e[t - 1].depth_m) / (e[t].depth_m - e[t - 1].depth_m);
    const auto between = [&](double a, double b) { return a + share * (b - a); };
    return std::array{between(e[t - 1].force_reference_n, e[t].force_reference_n),
                      between(e[t - 1].force_fast_n, e[t].force_fast_n)};
  }
  return std::nullopt;
}

std::string in_what(const std::string& differs) {
  return differs == "tool"    ? "another tool"
         : differs == "depth" ? "another depth"
         : differs == "place" ? "another place"
         : differs == "track" ? "another track"
                              : "another body";
}

}  // namespace

std::vector<std::string> notes_of(const StageFit& stage) {
  std::vector<std::string> notes;
  const Fit& fit = stage.fit;
  for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
    const TuningParameter& one = stage.parameters[k];
    const Determination& found = fit.parameters[k];
    if (found.at_bound != AtBound::no) {
      const bool low = found.at_bound == AtBound::low;
      notes.push_back(fmt::format(
          "{} ended at its {} bound, {}: the data favour a {} value. It has no standard error, and the errors of the "
          "others "
          "hold only if it stays there.",
          one.key, low ? "lower" : "upper", value_text(low ? one.low : one.high, one.unit), low ? "lower" : "higher"));
    } else if (found.open) {
      notes.push_back(fmt::format(
          "These data cannot determine {}: its uncertainty is no smaller than the range between its bounds, {} to {}; "
          "{} is where "
          "the "
          "search ended.",
          one.key, value_text(one.low, one.unit), value_text(one.high, one.unit), value_text(found.value, one.unit)));
    }
  }
  for (const std::vector<std::size_t>& direction : fit.open_directions) {
    if (direction.size() < 2) continue;
    std::string names;
    for (const std::size_t k : direction) names += (names.empty() ? "" : " and ") + stage.parameters[k].key;
    notes.push_back("Only a combination of " + names + " is determined: a change of one is compensated by the others.");
  }
  if (fit.rank < fit.free) {
    notes.push_back(
        fmt::format("The fit is rank deficient: {} of {} parameters away from their bounds have an effect of "
                    "their own.",
                    fit.rank, fit.free));
  }
  for (const Profile& profile : stage.profiles) {
    const TuningParameter& one = stage.parameters[profile.parameter];
    const Determination& found = fit.parameters[profile.parameter];
    if (found.open || found.at_bound != AtBound::no) continue;
    if (profile.open_low && profile.open_high) {
      notes.push_back(
          fmt::format("The profile of {} is flat between its bounds: these data cannot determine it.", one.key));
    } else if (profile.open_low || profile.open_high) {
      notes.push_back(fmt::format("By its profile {} is known only to be {} {}.", one.key,
                                  profile.open_low ? "below" : "above",
                                  value_text(profile.open_low ? profile.high : profile.low, one.unit)));
    }
  }
  return notes;
}

std::vector<std::string> limits_of(const Tuning& tuning, const TunedModel& model) {
  std::vector<std::string> limits;
  const ModelAccount& account = model.entry.account;
  const TuningOutcome& trained = model.outcomes.front();
  for (const char* differs : {"place", "tool", "depth", "track", "body"}) {
    const TuningOutcome* worst = nullptr;
    for (const TuningOutcome& one : model.outcomes) {
      if (tuning.data[one.data].contact.differs != differs || !one.errors.force_nrmse.value) continue;
      if (worst == nullptr || *one.errors.force_nrmse.value > *worst->errors.force_nrmse.value) worst = &one;
    }
    if (worst == nullptr) continue;
    const Errors& e = worst->errors;
    std::string text = fmt::format(
        "Force at {} (worst: \"{}\"): an error of {} of the peak, {} at the peak.", in_what(differs),
        tuning.data[worst->data].contact.name, percent_text(*e.force_nrmse.value),
        *e.force_peak_rel.value < 0.0 ? fmt::format("{} too weak", percent_text(-*e.force_peak_rel.value))
                                      : fmt::format("{} too strong", percent_text(*e.force_peak_rel.value)));
    const double depth_m = std::min(e.depth_max_m, trained.errors.depth_max_m);
    const auto here = forces_at_n(*worst, depth_m), there = forces_at_n(trained, depth_m);
    if (here && there && (*there)[0] > 0.0 && (*there)[1] > 0.0) {
      text += fmt::format(
          " From the training contact \"{}\" to this one, at {} depth, the reference's force changes by a factor of "
          "{}, "
          "the model's by {}.",
          tuning.data[trained.data].contact.name, quantity_text(depth_m, "m"), number_text((*here)[0] / (*there)[0]),
          number_text((*here)[1] / (*there)[1]));
    }
    if (!e.force_nrmse.distinguishable()) text += " That is not distinguishable from the reference's own uncertainty.";
    limits.push_back(std::move(text));
  }
  const TuningOutcome* worst = nullptr;
  for (const TuningOutcome& one : model.outcomes) {
    if (!tuning.data[one.data].held_out() || !one.errors.shape_rel_l2.value) continue;
    if (worst == nullptr || *one.errors.shape_rel_l2.value > *worst->errors.shape_rel_l2.value) worst = &one;
  }
  if (worst != nullptr && trained.errors.shape_rel_l2.value) {
    const Errors& e = worst->errors;
    std::string text = fmt::format(
        "Shape: an error of {} of the displacement on the training contact \"{}\", and up to {} on held-out contacts "
        "(\"{}\").",
        percent_text(*trained.errors.shape_rel_l2.value), tuning.data[trained.data].contact.name,
        percent_text(*e.shape_rel_l2.value), tuning.data[worst->data].contact.name);
    if (e.shape_inside_r_rel_l2.value && e.shape_outside_r_rel_l2.value && e.shape_error_outside_share) {
      text +=
          fmt::format(" There it is {} within the local radius and {} outside, where {} of the squared error lies{}.",
                      percent_text(*e.shape_inside_r_rel_l2.value), percent_text(*e.shape_outside_r_rel_l2.value),
                      percent_text(*e.shape_error_outside_share), account.far_shape);
    }
    if (e.shape_side_faces_rel_l2.value) {
      text += fmt::format(" On untouched faces{} it is {}.", account.untouched_faces,
                          percent_text(*e.shape_side_faces_rel_l2.value));
    }
    limits.push_back(std::move(text));
    if (model.shape_parts.empty()) return limits;
    fmt::dynamic_format_arg_store<fmt::format_context> errors;
    for (const double error : model.shape_parts) errors.push_back(percent_text(error));
    limits.push_back(fmt::format("Shape error by parts of the model, on the training contact \"{}\": {}.",
                                 tuning.data[trained.data].contact.name, fmt::vformat(account.parts_sentence, errors)));
  }
  return limits;
}

}  // namespace touchstone::compare
