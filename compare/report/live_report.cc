#include "compare/report/live_report.h"

#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

std::string us_text(double us) { return quantity_text(us, "us"); }

/// "1 tick", "2000 ticks".
std::string counted(double count, const std::string& one) {
  return fmt::format("{}{}{}{}", number_text(count), no_break, one, count == 1.0 ? "" : "s");
}
std::string counted(std::int64_t count, const std::string& one) { return counted(static_cast<double>(count), one); }

double period_us(const live::LiveResult& result) { return 1e6 / result.rate_hz; }

/// Number of ticks that were due.
std::int64_t due(const live::LiveResult& result) { return result.ledger.ticks + result.ledger.missed; }

double missed_part(const live::LiveResult& result) {
  return static_cast<double>(result.ledger.missed) / std::max(1.0, static_cast<double>(due(result)));
}

std::string device_words(live::DeviceKind device) {
  switch (device) {
    case live::DeviceKind::scripted:
      return "the scene's track, followed exactly";
    case live::DeviceKind::replay:
      return "the poses in the log of an earlier run";
    case live::DeviceKind::hand:
      return "a simulated hand, a mass with spring and damper that follows the scene's track";
  }
  return "an unknown device";
}

/// Middle of an interval of the history [s].
double time_s(const live::LiveResult& result, std::size_t interval) {
  const auto length = static_cast<double>(result.history.length());
  return (static_cast<double>(interval) * length + 0.5 * (length - 1.0)) / result.rate_hz;
}

std::string interval_words(const live::LiveResult& result) {
  const std::int64_t length = result.history.length();
  if (length == 1) return "";
  return fmt::format(" Each point is the largest of {} ({}).", counted(length, "tick"),
                     us_text(static_cast<double>(length) * period_us(result)));
}

/// Time of the largest force sent; empty if none was sent.
std::string when_largest(const live::LiveResult& result) {
  const std::vector<live::Interval>& intervals = result.history.intervals();
  const auto largest = std::ranges::max_element(intervals, {}, &live::Interval::force_max_n);
  if (largest == intervals.end() || !(largest->force_max_n > 0.0)) return "no contact";
  return "at " + seconds_text(time_s(result, static_cast<std::size_t>(largest - intervals.begin())));
}

std::string tiles(const scene::Scene& scene, const live::LiveResult& result) {
  const live::Ledger& ledger = result.ledger;
  const fast::Percentiles late = ledger.lateness.percentiles(), tick = ledger.step.percentiles();
  std::string out = "<div class=\"tiles\">\n";
  out += tile("Ticks done", number_text(static_cast<double>(ledger.ticks)),
              fmt::format("of {} due, {} a second", number_text(static_cast<double>(due(result))),
                          number_text(result.rate_hz)));
  out += tile("Ticks missed", number_text(static_cast<double>(ledger.missed)),
              ledger.missed == 0 ? "none" : percent_text(missed_part(result)) + " of those due");
  out += tile("Lateness, median", us_text(late.p50_us),
              fmt::format("99.9\u00a0% within {}, longest {}", us_text(late.p999_us), us_text(late.max_us)));
  out += tile("Longest tick", us_text(tick.max_us),
              fmt::format("median {}; the period is {}", us_text(tick.p50_us), us_text(period_us(result))));
  out += tile("Largest force sent", quantity_text(ledger.force_max_n, "N"),
              fmt::format("{}; limit {}", when_largest(result), quantity_text(scene.live.force_max_n, "N")));
  return out + "</div>\n";
}

/// Summary: whether all ticks were done and what was limited or missing.
std::string verdict(const live::LiveResult& result) {
  const live::Ledger& ledger = result.ledger;
  std::string out = ledger.ticks == 0 ? "No tick was done." : "";
  if (ledger.ticks > 0 && ledger.missed == 0) out = "Every tick was done.";
  if (ledger.missed > 0) {
    const bool one = ledger.missed == 1;
    out = fmt::format("{} of {} ticks {} missed: the loop reached {} more than a period late and skipped {}.",
                      number_text(static_cast<double>(ledger.missed)), number_text(static_cast<double>(due(result))),
                      one ? "was" : "were", one ? "it" : "them", one ? "it" : "them");
  }
  if (result.interrupted) out += " The run was ended early by a signal (Ctrl-C).";
  if (ledger.limited_ticks > 0) {
    out += fmt::format(" In {} a safety limit changed the model's force before it was sent.",
                       counted(ledger.limited_ticks, "tick"));
  }
  if (ledger.bad_poses > 0) {
    out += fmt::format(" In {} the device gave no usable pose; the last good force was held and faded to zero.",
                       counted(ledger.bad_poses, "tick"));
  }
  if (ledger.status != 0) out += " The model reported: " + fast::status_text(ledger.status) + ".";
  if (result.replay && !result.replay->equal()) out += " The answers differ from the log's.";
  return out;
}

Plot plot_of(const std::string& title, const std::string& x_label, const std::string& y_label) {
  Plot plot;
  plot.title = title;
  plot.x_label = x_label;
  plot.y_label = y_label;
  return plot;
}

Plot force_plot(const scene::Scene& scene, const live::LiveResult& result) {
  Plot plot = plot_of("Force over time", "time [s]", "force [N]");
  Curve sent{"sent to the device", Look::first, {}, {}}, model{"of the model", Look::plain, {}, {}};
  bool differ = false;
  const std::vector<live::Interval>& intervals = result.history.intervals();
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const live::Interval& one = intervals[i];
    const bool known = one.ticks > 0;
    for (Curve* curve : {&sent, &model}) curve->x.push_back(time_s(result, i));
    sent.y.push_back(known ? one.force_max_n : no_value);
    model.y.push_back(known ? one.model_force_max_n : no_value);
    differ = differ || one.force_max_n != one.model_force_max_n;
  }
  sent.hidden_markers = model.hidden_markers = true;
  const double limit_n = scene.live.force_max_n;
  if (!intervals.empty() && result.ledger.model_force_max_n > 0.5 * limit_n) {
    Curve limit{"limit", Look::outline, {time_s(result, 0), time_s(result, intervals.size() - 1)}, {limit_n, limit_n}};
    limit.markers = false;
    plot.curves.push_back(limit);
  }
  if (differ) plot.curves.push_back(model);
  plot.curves.push_back(sent);
  return plot;
}

/// Histogram with ten columns per decade; the logarithmic count axis makes few long ticks visible.
Plot histogram_plot(const std::string& title, const fast::DurationHistogram& histogram, const std::string& x_label,
                    double period_us) {
  Plot plot = plot_of(title, x_label + " [µs]", "ticks");
  plot.x_log = plot.y_log = true;
  if (histogram.count() == 0) return plot;
  const auto step_at = [](double ns) { return static_cast<int>(std::floor(10.0 * std::log10(std::max(ns, 10.0)))); };
  const auto edge_ns = [](int step) { return std::pow(10.0, 0.1 * step); };
  const int first = step_at(histogram.percentile_ns(1e-12));
  const int last = std::max(first, step_at(static_cast<double>(histogram.max_ns())));
  Bars bars{"", Look::fast, {1e-3 * edge_ns(first)}, {}};
  for (int step = first; step <= last; ++step) {
    bars.edges.push_back(1e-3 * edge_ns(step + 1));
    bars.heights.push_back(static_cast<double>(
        histogram.count_between(step == first ? 0.0 : edge_ns(step),
                                step == last ? std::numeric_limits<double>::infinity() : edge_ns(step + 1))));
  }
  // The axis begins at half a tick, so that a single tick is visible.
  plot.y_range = {0.5, 2.0 * std::ranges::max(bars.heights)};
  if (bars.edges.back() > period_us) plot.spans.push_back({"more than a period", period_us, bars.edges.back() * 2.0});
  plot.bars.push_back(std::move(bars));
  return plot;
}

std::string histogram_caption(const fast::DurationHistogram& histogram) {
  const fast::Percentiles p = histogram.percentiles();
  return fmt::format("Median {}, 99\u00a0% within {}, 99.9\u00a0% within {}, longest {}.", us_text(p.p50_us),
                     us_text(p.p99_us), us_text(p.p999_us), us_text(p.max_us));
}

std::string first_screen(const scene::Scene& scene, const live::LiveOptions& options, const live::LiveResult& result) {
  std::string out = tag("h1", scene_title(scene)) + "\n";
  out += tag("p",
             fmt::format("The fast contact model in real time at {} ticks a second over {}. The device: {}.",
                         number_text(result.rate_hz), seconds_text(result.planned_s), device_words(options.device)),
             "class=\"dim\"") +
         "\n";
  out += tiles(scene, result) + tag("p", verdict(result), "class=\"lead\"") + "\n<div class=\"plots\">\n";
  out += figure(to_svg(force_plot(scene, result)), "Size of the force on the tool." + interval_words(result) +
                                                       " The line is broken where no tick was done.");
  out += figure(to_svg(histogram_plot("Lateness of the loop", result.ledger.lateness, "lateness", period_us(result))),
                "How long after its due time the loop woke for a tick. Both axes are logarithmic. " +
                    histogram_caption(result.ledger.lateness));
  return out + "</div>\n";
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr>" + tag("th", name) + cell(value) + "</tr>\n";
}

std::string replay_words(const live::ReplayAnswer& replay) {
  if (replay.equal()) return fmt::format("all {} equal the log's to the last bit", counted(replay.rows, "answer"));
  if (replay.unequal > 0) {
    return fmt::format("{} of {} differ from the log's, the first on line {} of the log; is it the same scene?",
                       number_text(static_cast<double>(replay.unequal)), counted(replay.compared, "answer"),
                       replay.first_unequal + 2);
  }
  return fmt::format("ended after {} of {}, all equal to the log's", number_text(static_cast<double>(replay.compared)),
                     counted(replay.rows, "tick"));
}

Section faults_section(const live::LiveResult& result) {
  const live::Ledger& ledger = result.ledger;
  std::string out = "<div class=\"scroll\"><table>\n";
  out += row("model", ledger.status == 0 ? "nothing to report" : fast::status_text(ledger.status));
  out += row("poses", ledger.bad_poses == 0
                          ? "all usable"
                          : fmt::format("{} without a usable pose; the last good force was held and faded to zero",
                                        counted(ledger.bad_poses, "tick")));
  out += row("force limits",
             ledger.limited_ticks == 0
                 ? "never reached"
                 : fmt::format("in {} the force sent is not the model's, whose largest is {}",
                               counted(ledger.limited_ticks, "tick"), quantity_text(ledger.model_force_max_n, "N")));
  out += row("log", result.dropped_records == 0
                        ? "live.csv has every tick"
                        : fmt::format("live.csv lacks {}: the disk was too slow. It cannot be replayed.",
                                      counted(static_cast<double>(result.dropped_records), "tick")));
  out += row("scheduling", result.scheduling.text());
  for (const std::string& warning : result.scheduling.warnings) out += row("warning", warning);
  if (result.replay) out += row("replay", replay_words(*result.replay));
  out += row("end", result.interrupted ? "by a signal (Ctrl-C), early" : "as planned");
  return {"Status and faults", out + "</table></div>\n"};
}

Section missed_section(const live::LiveResult& result) {
  const live::Ledger& ledger = result.ledger;
  const std::string rule =
      "A tick that starts less than a period late is done late. One that is later is missed: it is skipped "
      "and not made up for.";
  if (ledger.missed == 0) return {"Missed ticks", tag("p", "None. " + rule) + "\n"};
  Plot plot = plot_of("Missed ticks over time", "time [s]", "ticks missed");
  Bars bars{"", Look::fast, {}, {}};
  const std::vector<live::Interval>& intervals = result.history.intervals();
  const double half_s = 0.5 * static_cast<double>(result.history.length()) / result.rate_hz;
  if (!intervals.empty()) bars.edges.push_back(time_s(result, 0) - half_s);
  std::int64_t shown = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    bars.edges.push_back(time_s(result, i) + half_s);
    bars.heights.push_back(static_cast<double>(intervals[i].missed));
    shown += intervals[i].missed;
  }
  if (!intervals.empty()) plot.x_range = {std::max(0.0, bars.edges.front()), bars.edges.back()};
  // The axis has whole numbers even if only one tick was missed.
  if (!bars.heights.empty()) plot.y_range = {0.0, std::max(4.0, 1.1 * std::ranges::max(bars.heights))};
  plot.bars.push_back(std::move(bars));
  std::string caption = "Drawn where the loop went on after them.";
  if (shown < ledger.missed) caption += fmt::format(" {} more after the last tick done.", ledger.missed - shown);
  return {"Missed ticks", tag("p", fmt::format("{} of {}, {}. {}", number_text(static_cast<double>(ledger.missed)),
                                               counted(due(result), "tick"), percent_text(missed_part(result)), rule)) +
                              "\n" + figure(to_svg(plot, 560, 260), caption)};
}

std::string percentiles_row(const std::string& name, const fast::DurationHistogram& histogram) {
  const fast::Percentiles p = histogram.percentiles();
  return "<tr>" + cell(name) + number_cell(us_text(p.p50_us)) + number_cell(us_text(p.p99_us)) +
         number_cell(us_text(p.p999_us)) + number_cell(us_text(p.max_us)) + "</tr>\n";
}

Section tick_section(const live::LiveResult& result) {
  const live::Ledger& ledger = result.ledger;
  std::string out = "<div class=\"plots\">\n";
  const auto add = [&](const std::string& title, const fast::DurationHistogram& histogram, const std::string& words) {
    out += figure(to_svg(histogram_plot(title, histogram, "time", period_us(result)), 560, 300),
                  words + " " + histogram_caption(histogram));
  };
  add("The whole tick", ledger.step, "From waking to the end of the tick.");
  add("From pose to force", ledger.force, "From waking until the device has the force.");
  out += "</div>\n<table>\n<tr><th>Time</th>";
  for (const char* head : {"median", "99 %", "99.9 %", "longest"}) out += tag("th", head, "class=\"n\"");
  out += "</tr>\n" + percentiles_row("lateness", ledger.lateness) + percentiles_row("pose to force", ledger.force) +
         percentiles_row("shape, after the force", ledger.shape) + percentiles_row("whole tick", ledger.step);
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    if (ledger.stages[s].count() > 0) {
      out += percentiles_row(std::string("stage ") + fast::stage_names[s], ledger.stages[s]);
    }
  }
  out += percentiles_row("age of the shape when read", result.shape_age);
  return {"Time of a tick", out + "</table>\n"};
}

Section stages_section(const live::LiveResult& result) {
  std::string out = "<div class=\"plots\">\n";
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    const fast::DurationHistogram& stage = result.ledger.stages[s];
    if (stage.count() == 0) continue;
    out += figure(to_svg(histogram_plot(fast::stage_names[s], stage, "time", period_us(result)), 560, 260),
                  fmt::format("Of the {} in which it ran. {}", counted(static_cast<double>(stage.count()), "tick"),
                              histogram_caption(stage)));
  }
  return {"Each stage of the model", out + "</div>\n", true};
}

Section settings_section(const scene::Scene& scene, const live::LiveOptions& options, const live::LiveResult& result) {
  const scene::LiveSettings& live = scene.live;
  std::string out = "<div class=\"scroll\"><table>\n";
  out += row("device", live::name_of(options.device) + ": " + device_words(options.device));
  if (!options.log.empty()) out += row("log played", options.log.string());
  out += row("rate",
             fmt::format("{}{}Hz, a period of {}", number_text(result.rate_hz), no_break, us_text(period_us(result))));
  out += row("planned length", seconds_text(result.planned_s));
  out += row("largest force", fmt::format("{}; the torque is limited to this times the tool's reach",
                                          quantity_text(live.force_max_n, "N")));
  out += row("fastest change of force", quantity_text(live.force_slew_n_per_s, "N/s"));
  out += row("after a bad pose", fmt::format("the force falls to zero in {}", quantity_text(live.release_s, "s")));
  if (options.device == live::DeviceKind::hand) {
    out +=
        row("simulated hand", fmt::format("mass {}, damping {}, stiffness {}", quantity_text(live.hand_mass_kg, "kg"),
                                          quantity_text(live.hand_damping_n_s_per_m, "N s/m"),
                                          quantity_text(live.hand_stiffness_n_per_m, "N/m")));
  }
  return {"Settings of the loop", out + "</table></div>\n"};
}

}  // namespace

std::string live_report_html(const scene::Scene& scene, const live::LiveOptions& options,
                             const live::LiveResult& result, const scene::Manifest& manifest) {
  const std::vector<Section> sections{
      faults_section(result),
      missed_section(result),
      tick_section(result),
      stages_section(result),
      settings_section(scene, options, result),
      origin(manifest,
             "Beside this page: live.csv (every tick), summary.json (every number), manifest.json. "
             "--device replay --log live.csv computes the same poses again."),
      resolved_scene(manifest)};
  return page(scene_title(scene), first_screen(scene, options, result) + contents(sections) + in_order(sections));
}

std::filesystem::path write_live_report(const std::filesystem::path& folder, const scene::Scene& scene,
                                        const live::LiveOptions& options, const live::LiveResult& result,
                                        const scene::Manifest& manifest) {
  std::filesystem::path file = folder / "report.html";
  scene::write_file(file, live_report_html(scene, options, result, manifest));
  return file;
}

}  // namespace touchstone::compare
