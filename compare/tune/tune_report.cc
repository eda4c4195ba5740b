#include "compare/tune/tune_report.h"

#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/comparison_drawings.h"
#include "scene/input/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

std::string measure_cell(const Measure& measure, const std::string& unit) {
  if (!measure.value) return number_cell("–");
  const auto under = [](const std::string& text) { return tag("span", text, "class=\"under\""); };
  std::string out = escape_xml(quantity_text(*measure.value, unit));
  out += under("± " + quantity_text(measure.uncertainty, unit, "unknown"));
  if (!measure.distinguishable()) out += under("not distinguishable");
  return "<td class=\"n\">" + out + "</td>";
}

/// The largest value of one error over the contacts; null if no contact has it.
const Measure* worst(const Tuning& tuning, const TunedModel& model, bool held_out, Measure Errors::*figure) {
  const Measure* found = nullptr;
  for (const TuningOutcome& outcome : model.outcomes) {
    const Measure& one = outcome.errors.*figure;
    if (tuning.data[outcome.data].held_out() != held_out || !one.value) continue;
    if (found == nullptr || std::abs(*one.value) > std::abs(*found->value)) found = &one;
  }
  return found;
}

std::string worst_tile(const Tuning& tuning, bool held_out, const std::string& what, Measure Errors::*figure) {
  const Measure* found = worst(tuning, tuning.models.front(), held_out, figure);
  return tile(what, found != nullptr ? percent_text(*found->value) : "–",
              held_out ? "the worst held-out contact" : "the worst training contact");
}

std::string head_section(const Tuning& tuning) {
  const TuningStudy& study = tuning.study;
  std::string out = tag("h1", study.title.empty() ? study.name : study.title) + "\n";
  out +=
      tag("p",
          "The fast model's free constants, fitted to the finite-element reference on training contacts and judged on "
          "contacts that the fit does not use.",
          "class=\"dim\"") +
      "\n<div class=\"tiles\">\n";
  out += worst_tile(tuning, true, "Force error held out, of the peak", &Errors::force_nrmse);
  out += worst_tile(tuning, true, "Shape error held out, of the displacement", &Errors::shape_rel_l2);
  out += worst_tile(tuning, false, "Force error in training, of the peak", &Errors::force_nrmse);
  out += worst_tile(tuning, false, "Shape error in training, of the displacement", &Errors::shape_rel_l2);
  out += "</div>\n<div class=\"verdict\">\n" + tag("p", "What limits the " + tuning.models.front().name() + " model:") +
         "\n";
  for (const std::string& sentence : tuning.models.front().limits) out += tag("p", sentence) + "\n";
  return out + "</div>\n";
}

/// A column of the error tables.
struct ErrorColumn {
  const char* head;
  Measure Errors::*figure;
  const char* unit = "";
};

constexpr ErrorColumn error_columns[] = {{"force, of the peak", &Errors::force_nrmse},
                                         {"force, at the peak", &Errors::force_peak_rel},
                                         {"force, relative", &Errors::force_rel_deep},
                                         {"friction, of its peak", &Errors::force_friction_nrmse},
                                         {"slip onset", &Errors::slip_onset_error_m, "m"},
                                         {"shape", &Errors::shape_rel_l2},
                                         {"within the local radius", &Errors::shape_inside_r_rel_l2},
                                         {"beyond it", &Errors::shape_outside_r_rel_l2},
                                         {"on the side faces", &Errors::shape_side_faces_rel_l2},
                                         {"largest, of the depth", &Errors::shape_max_over_depth}};

/// The columns for which some contact has a value.
std::vector<ErrorColumn> columns_in_use(const Tuning& tuning) {
  std::vector<ErrorColumn> columns;
  for (const ErrorColumn& column : error_columns) {
    const bool in_use = std::any_of(tuning.models.begin(), tuning.models.end(), [&](const TunedModel& model) {
      return worst(tuning, model, true, column.figure) != nullptr ||
             worst(tuning, model, false, column.figure) != nullptr;
    });
    if (in_use) columns.push_back(column);
  }
  return columns;
}

std::string errors_table(const Tuning& tuning, bool held_out) {
  const std::vector<ErrorColumn> columns = columns_in_use(tuning);
  std::string out = tag("h2", held_out ? "On held-out contacts" : "On training contacts") +
                    "\n<div class=\"scroll\"><table>\n<tr><th>Contact</th>" +
                    std::string(held_out ? "<th>differs in</th>" : "");
  for (const ErrorColumn& column : columns) out += tag("th", column.head, "class=\"wrap\"");
  out += "</tr>\n";
  for (const TunedModel& model : tuning.models) {
    out += fmt::format("<tr class=\"group\"><th colspan=\"{}\">{}</th></tr>\n", columns.size() + (held_out ? 2 : 1),
                       escape_xml(model.name()));
    for (const TuningOutcome& outcome : model.outcomes) {
      const TuningData& data = tuning.data[outcome.data];
      if (data.held_out() != held_out) continue;
      const Errors& e = outcome.errors;
      out += "<tr>" + cell(data.contact.name) + (held_out ? cell(data.contact.differs) : "");
      for (const ErrorColumn& column : columns) {
        out += measure_cell(e.*column.figure, column.unit);
      }
      out += "</tr>\n";
    }
  }
  return out + "</table></div>\n";
}

std::string errors_note() {
  return tag("p",
             "The number after ± is the reference's own uncertainty in the same norm. Force of the peak: root mean "
             "square "
             "over "
             "the instants, relative to the largest force; relative: root mean square where the depth is above 10 % of "
             "its largest. Shape: of the displacement, by area and over the instants; side faces are those that are "
             "never touched, where edges make faces.",
             "class=\"dim\"") +
         "\n";
}

std::string unit_text(double value, const std::string& unit) {
  return number_text(value) + (unit.empty() ? "" : std::string(no_break) + unit);
}

std::string error_text(const TuningParameter& parameter, const Determination& found, bool another_at_bound) {
  if (found.at_bound != AtBound::no)
    return found.at_bound == AtBound::low ? "none: at its lower bound" : "none: at its upper bound";
  if (!found.error) return "none: not determined by the data";
  return "± " + (parameter.log ? percent_text(*found.error) : unit_text(*found.error, parameter.unit)) +
         (another_at_bound ? ", with the bound held" : "");
}

std::string parameter_table(const StageFit& stage) {
  const bool bound = std::any_of(stage.fit.parameters.begin(), stage.fit.parameters.end(),
                                 [](const Determination& one) { return one.at_bound != AtBound::no; });
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th>Parameter</th><th class=\"n\">value</th><th class=\"n\">standard "
      "error</th>"
      "<th class=\"n\">bounds</th><th>searched</th></tr>\n";
  for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
    const TuningParameter& one = stage.parameters[k];
    const Determination& found = stage.fit.parameters[k];
    const std::string meaning(scene::tunable_field(one.key)->doc);
    out += "<tr><td>" + escape_xml(one.key) + tag("span", meaning, "class=\"under\"") + "</td>" +
           number_cell(unit_text(found.value, one.unit)) + number_cell(error_text(one, found, bound)) +
           number_cell(number_text(one.low) + " to " + unit_text(one.high, one.unit)) +
           cell(one.log ? "in its logarithm" : "evenly") + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string fit_sentence(const StageFit& stage) {
  const Fit& fit = stage.fit;
  return fmt::format(
      "{} of {} starts ended at the same place. The squared differences, in units of the reference's uncertainty, "
      "come to {} per degree of freedom{}. Rank {} of {}, condition {}.",
      fit.starts_agreeing, fit.starts.size(), number_text(fit.chi2_per_freedom),
      fit.chi2_per_freedom > 2.0 ? ": the model cannot follow the data, so the standard errors reflect the misfit" : "",
      fit.rank, fit.free, std::isfinite(fit.condition) ? number_text(fit.condition) : "infinite");
}

std::string correlation_table(const StageFit& stage) {
  if (stage.parameters.size() < 2) return "";
  std::string out = tag("h4", "Correlation") + "\n<div class=\"scroll\"><table>\n<tr><th></th>";
  for (const TuningParameter& one : stage.parameters) out += tag("th", one.key, "class=\"n\"");
  out += "</tr>\n";
  for (std::size_t i = 0; i < stage.parameters.size(); ++i) {
    out += "<tr>" + tag("th", stage.parameters[i].key);
    for (std::size_t j = 0; j < stage.parameters.size(); ++j) {
      const double c = stage.fit.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      out += number_cell(std::isnan(c) ? "–" : fmt::format("{:.3f}", c));
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string starts_table(const StageFit& stage) {
  std::string out = "<details>\n<summary>Every start</summary>\n<div class=\"scroll\"><table>\n<tr>";
  for (const TuningParameter& one : stage.parameters) out += tag("th", one.key, "class=\"n\"");
  out += "<th class=\"n\">squared differences</th></tr>\n";
  for (const FitStart& start : stage.fit.starts) {
    out += "<tr>";
    for (Eigen::Index k = 0; k < start.from.size(); ++k) {
      out += number_cell(number_text(start.from[k]) + " → " + number_text(start.to[k]));
    }
    out += number_cell(start.chi2 ? number_text(*start.chi2) : "no result there") + "</tr>\n";
  }
  return out + "</table></div>\n</details>\n";
}

std::string profile_plots(const StageFit& stage) {
  if (stage.profiles.empty()) return "";
  std::string out = "<div class=\"plots\">\n";
  for (const Profile& profile : stage.profiles) {
    const TuningParameter& one = stage.parameters[profile.parameter];
    Plot plot;
    plot.title = "Profile of " + one.key;
    plot.x_label = one.key + (one.unit.empty() ? "" : " [" + one.unit + "]");
    plot.y_label = "squared differences / minimum";
    plot.x_log = one.log;
    Curve curve{"the others fitted", Look::fast, profile.values, {}};
    for (const double chi2 : profile.chi2) curve.y.push_back(chi2 / stage.fit.chi2);
    plot.curves.push_back(std::move(curve));
    if (profile.high > profile.low) plot.spans.push_back({"as good within the scatter", profile.low, profile.high});
    out += figure(to_svg(plot), "Every other parameter of the stage is fitted anew at each value.");
  }
  return out + "</div>\n";
}

std::string stage_section(const StageFit& stage) {
  std::string out =
      tag("h3", stage.stage == TuningStage::force ? "Force" : "Shape, with the force constants as fitted") + "\n";
  out += parameter_table(stage) + tag("p", fit_sentence(stage)) + "\n";
  for (const std::string& note : stage.notes) out += tag("p", note) + "\n";
  return out + correlation_table(stage) + profile_plots(stage) + starts_table(stage);
}

Plot residual_plot(const Tuning& tuning, const TunedModel& model) {
  Plot plot;
  plot.title = "Residuals on the training contacts";
  plot.x_label = "depth [mm]";
  plot.y_label = "force, model − reference [% of the peak]";
  constexpr Look looks[] = {Look::first, Look::second, Look::third, Look::plain};
  std::size_t next = 0;
  for (const TuningOutcome& outcome : model.outcomes) {
    const TuningData& data = tuning.data[outcome.data];
    if (data.held_out()) continue;
    Curve curve{data.contact.name, looks[next++ % std::size(looks)], {}, {}};
    for (const InstantErrors& e : outcome.errors.instants) {
      curve.x.push_back(1e3 * e.depth_m);
      curve.y.push_back(100.0 * (e.force_fast_n - e.force_reference_n) / outcome.errors.force_peak_reference_n);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// Points without a connecting line: each is followed by a gap.
Plot regime_plot(const TunedModel& model, const std::string& y_label,
                 const std::function<double(const RegimePoint&)>& y_of) {
  Plot plot;
  plot.title = "Range of validity of the force";
  plot.x_label = "depth / radius";
  plot.y_label = y_label;
  plot.curves = {{"within 5 %", Look::first, {}, {}},
                 {"within 10 %", Look::second, {}, {}},
                 {"within 20 %", Look::third, {}, {}},
                 {"larger error", Look::plain, {}, {}}};
  for (const TuningOutcome& outcome : model.outcomes) {
    for (const RegimePoint& point : outcome.regime) {
      const auto limit = std::find_if(std::begin(regime_limits), std::end(regime_limits),
                                      [&](double each) { return point.force_error_rel <= each; });
      Curve& curve = plot.curves[static_cast<std::size_t>(limit - std::begin(regime_limits))];
      curve.x.insert(curve.x.end(), {point.depth_over_radius, no_value});
      curve.y.insert(curve.y.end(), {y_of(point), no_value});
    }
  }
  return plot;
}

/// Ranges of depth over radius in which the error of every instant is within a limit.
std::string within_text(const std::vector<RegimePoint>& regime, double limit) {
  std::vector<RegimePoint> sorted = regime;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.depth_over_radius < b.depth_over_radius; });
  std::string text;
  for (std::size_t k = 0; k < sorted.size();) {
    if (!(sorted[k].force_error_rel <= limit)) {
      ++k;
      continue;
    }
    std::size_t last = k;
    while (last + 1 < sorted.size() && sorted[last + 1].force_error_rel <= limit) ++last;
    text += (text.empty() ? "" : ", ") + number_text(sorted[k].depth_over_radius, 2);
    if (last > k) text += " to " + number_text(sorted[last].depth_over_radius, 2);
    k = last + 1;
  }
  return text.empty() ? "nowhere" : text;
}

std::string regime_section(const Tuning& tuning, const TunedModel& model) {
  std::string out = tag("h3", "Regime map: where the force is within 5, 10 and 20 %") + "\n<div class=\"plots\">\n";
  // Contacts at the trained place alone have no distance to show.
  constexpr double same_place_m = 1e-6;
  const bool elsewhere = std::ranges::any_of(model.outcomes, [](const TuningOutcome& outcome) {
    return std::ranges::any_of(outcome.regime, [](const RegimePoint& p) { return p.place_m > same_place_m; });
  });
  if (elsewhere) {
    out += figure(
        to_svg(regime_plot(model, "from the trained place [mm]", [](const RegimePoint& p) { return 1e3 * p.place_m; })),
        "Distance of the contact from the nearest trained one.");
  }
  out += figure(to_svg(regime_plot(model, "contact area [mm²]", [](const RegimePoint& p) { return 1e6 * p.area_m2; })),
                "One point per instant above 10 % of its contact's depth; area of the reference's contact.");
  out +=
      "</div>\n<div class=\"scroll\"><table>\n<tr><th>Contact</th><th class=\"n\">from the trained place</th><th "
      "class=\"n\">"
      "contact area</th><th class=\"n\">depth / radius</th><th class=\"n\">within 5 %</th><th class=\"n\">within 10 "
      "%</th>"
      "<th class=\"n\">within 20 %</th></tr>\n";
  for (const TuningOutcome& outcome : model.outcomes) {
    if (outcome.regime.empty()) continue;
    const auto range = [&](auto get) {
      double low = INFINITY, high = -INFINITY;
      for (const RegimePoint& p : outcome.regime) {
        low = std::min(low, get(p));
        high = std::max(high, get(p));
      }
      return std::pair(low, high);
    };
    const auto place = range([](const RegimePoint& p) { return 1e3 * p.place_m; });
    const auto area = range([](const RegimePoint& p) { return 1e6 * p.area_m2; });
    const auto depth = range([](const RegimePoint& p) { return p.depth_over_radius; });
    out += "<tr>" + cell(tuning.data[outcome.data].contact.name) + number_cell(number_text(place.second) + " mm") +
           number_cell(number_text(area.first) + " to " + number_text(area.second) + " mm²") +
           number_cell(number_text(depth.first, 2) + " to " + number_text(depth.second, 2));
    for (const double limit : regime_limits) out += number_cell(within_text(outcome.regime, limit));
    out += "</tr>\n";
  }
  return out + "</table></div>\n" +
         tag("p",
             "Within: the stretches of depth / radius, from instant to instant. The radius is the tool's where it is "
             "round, "
             "elsewhere that of a disc of the contact's area.",
             "class=\"dim\"") +
         "\n";
}

std::string model_section(const Tuning& tuning, const TunedModel& model) {
  std::string out = tag("h2", "The " + model.name() + " model") + "\n";
  // The findings on the first model are at the top of the page.
  if (&model != &tuning.models.front()) {
    for (const std::string& sentence : model.limits) out += tag("p", sentence) + "\n";
  }
  for (const StageFit& stage : model.stages) out += stage_section(stage);
  out += tag("h3", "Fit and held-out forces") + "\n<div class=\"plots\">\n";
  out += figure(to_svg(residual_plot(tuning, model)), "A pattern shows a wrong form of the law, not noise.");
  for (const TuningOutcome& outcome : model.outcomes) {
    const TuningData& data = tuning.data[outcome.data];
    Plot force = force_plot(outcome.errors);
    force.title = data.contact.name + (data.held_out() ? " (held out)" : " (training)");
    out += figure(to_svg(force), "");
  }
  return out + "</div>\n" + regime_section(tuning, model);
}

std::string data_section(const Tuning& tuning) {
  std::string out =
      tag("h2", "The contacts and their reference") +
      "\n<div class=\"scroll\"><table>\n<tr><th>Contact</th><th>scene</th><th class=\"n\">instants</th><th class=\"n\">"
      "force uncertainty</th><th class=\"n\">shape uncertainty</th><th>model</th></tr>\n";
  for (const TuningData& data : tuning.data) {
    out += "<tr>" + cell(data.contact.name) + cell(data.contact.scene.name) +
           number_cell(number_text(static_cast<double>(data.instants.size()))) +
           number_cell(quantity_text(data.result.force_uncertainty_rel, "", "unknown")) +
           number_cell(quantity_text(data.result.shape_uncertainty_rel, "", "unknown")) + cell(data.result.model) +
           "</tr>\n";
  }
  return out + "</table></div>\n" +
         tag("p",
             fmt::format(
                 "Differences are divided by the reference's uncertainty, but at least by {} of a contact's peak "
                 "force and {} of its displacement, which also replace an unknown uncertainty. An "
                 "instant counts as one observation: the points of one surface are correlated.",
                 percent_text(tuning.study.force_floor), percent_text(tuning.study.shape_floor)),
             "class=\"dim\"") +
         "\n";
}

}  // namespace

std::string tuning_report_html(const Tuning& tuning, const scene::Manifest& manifest) {
  std::string out = head_section(tuning) + errors_table(tuning, true) + errors_table(tuning, false) + errors_note();
  for (const TunedModel& model : tuning.models) out += model_section(tuning, model);
  out += data_section(tuning);
  out += manifest_section(
      manifest,
      "Beside this page: parameters.toml (the first model's values, for a scene to include), one such file "
      "for every model, summary.json (every figure), curve.csv (every instant), manifest.json.");
  return page(tuning.study.title.empty() ? tuning.study.name : tuning.study.title, out);
}

}  // namespace touchstone::compare
