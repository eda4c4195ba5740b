// Writes the files of a trade.
#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/trade/trade.h"
#include "fast/bench/report.h"
#include "scene/base/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::compare {
namespace {

constexpr std::string_view nothing = "–";

/// The two errors that rows are compared by.
struct Judged {
  TradeError error;
  const char* what;
  const char* key;
  const char* label;
};
constexpr Judged judged[] = {
    {&TradeRow::force_nrmse, "force", "force.nrmse", "force error, root mean square over the peak [%]"},
    {&TradeRow::shape_rel_l2, "shape", "shape.rel_l2", "shape error, of the displacement [%]"}};

struct FamilyStyle {
  ModelFamily family;
  const char* name;
  const char* colour;
};
constexpr FamilyStyle families[] = {
    {ModelFamily::paper, "the paper's model", "#e4600a"}, {ModelFamily::area_aware, "area-aware law", "#a03070"},
    {ModelFamily::response, "response", "#d62728"},       {ModelFamily::compliance, "linear compliance", "#2e8b57"},
    {ModelFamily::simulator, "Bullet", "#6a51a3"},        {ModelFamily::reference, "reference", "#1f77b4"},
    {ModelFamily::other, "other models", "#555555"}};

std::string number(double value, std::string_view unit) {
  return std::isfinite(value) ? quantity_text(value, unit) : std::string(nothing);
}

std::string error_text(const Measure& error) {
  if (!error.value) return std::string(nothing);
  std::string text = percent_text(*error.value);
  text += " ± " + quantity_text(error.uncertainty, "", "unknown");
  return error.distinguishable() ? text : text + ", not distinguishable";
}

/// For both errors the name of the row that dominates a row; "front" if none does, a dash if it cannot be judged.
std::vector<std::array<std::string, 2>> standing(const Trade& trade, std::string TradeRow::*name) {
  std::vector<std::array<std::string, 2>> out(trade.rows.size());
  for (std::size_t f = 0; f < 2; ++f) {
    const auto by = dominating(trade.rows, judged[f].error);
    const auto front = pareto_front(trade.rows, judged[f].error);
    for (std::size_t i = 0; i < trade.rows.size(); ++i) {
      out[i][f] = by[i]                                                     ? trade.rows[*by[i]].*name
                  : std::find(front.begin(), front.end(), i) != front.end() ? "front"
                                                                            : std::string(nothing);
    }
  }
  return out;
}

std::string one_plot(const Trade& trade, const Judged& figure, int width_px, int height_px) {
  Plot plot;
  plot.title = std::string("Time of a step over the error of the ") + figure.what;
  plot.x_label = figure.label;
  plot.y_label = "time of a step, median [µs]";
  plot.x_log = plot.y_log = true;
  const auto percent = [&](const TradeRow& row) { return 100.0 * judged_error(row.*figure.error).value_or(NAN); };
  Curve front{"nothing is faster and more accurate", Look::outline, {}, {}, false};
  for (const std::size_t k : pareto_front(trade.rows, figure.error)) {
    front.x.push_back(percent(trade.rows[k]));
    front.y.push_back(trade.rows[k].step_p50_us);
  }
  plot.curves.push_back(std::move(front));
  for (const FamilyStyle& style : families) {
    // Points without connecting lines.
    Curve points{style.name, Look::plain, {}, {}, true, false, style.colour};
    for (const TradeRow& row : trade.rows) {
      if (row.family != style.family || !std::isfinite(percent(row)) || !std::isfinite(row.step_p50_us)) continue;
      points.x.insert(points.x.end(), {percent(row), NAN});
      points.y.insert(points.y.end(), {row.step_p50_us, NAN});
      plot.names.push_back({row.label, percent(row), row.step_p50_us});
    }
    if (!points.x.empty()) plot.curves.push_back(std::move(points));
  }
  return to_svg(plot, width_px, height_px);
}

std::string judged_on(const Trade& trade) {
  std::string names;
  for (const TuningContact& contact : trade.contacts) names += (names.empty() ? "" : "; ") + contact.name;
  return trade.held_out ? "Errors are the worst of the held-out contacts: " + names + "."
                        : "Errors are those on the scene's own contacts.";
}

std::string table(const Trade& trade) {
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th>Model</th><th class=\"n\">step p50</th><th class=\"n\">p99.9</th>"
      "<th class=\"n\">set-up</th><th class=\"n\">memory</th><th class=\"n\">size</th><th class=\"n\">force</th>"
      "<th>dominated in force by</th><th class=\"n\">shape</th><th>dominated in shape by</th></tr>\n";
  const auto stands = standing(trade, &TradeRow::label);
  const auto error_cell = [](const Measure& error) { return tag("td", error_text(error), "class=\"t\""); };
  for (std::size_t i = 0; i < trade.rows.size(); ++i) {
    const TradeRow& row = trade.rows[i];
    out += "<tr>" + cell(row.name);
    if (!row.absent.empty()) {
      out += tag("td", "absent: " + row.absent, "colspan=\"9\"") + "</tr>\n";
      continue;
    }
    out += number_cell(number(row.step_p50_us, "us")) + number_cell(number(row.step_p999_us, "us")) +
           number_cell(number(row.setup_s, "s")) + number_cell(number(row.memory_bytes, "byte")) +
           number_cell(number_text(row.size, 6)) + error_cell(row.force_nrmse) + cell(stands[i][0]) +
           error_cell(row.shape_rel_l2) + cell(stands[i][1]) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string notes(const Trade& trade) {
  std::string out = "<dl>\n";
  for (const TradeRow& row : trade.rows) {
    std::string text = row.note;
    if (trade.held_out && row.force_nrmse.value) {
      text += (text.empty() ? "" : "; ") + std::string("force worst on ") + row.force_contact;
    }
    if (trade.held_out && row.shape_rel_l2.value) {
      text += (text.empty() ? "" : "; ") + std::string("shape worst on ") + row.shape_contact;
    }
    if (row.absent.empty() && row.steps > 0) {
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", row.steps,
                          row.family == ModelFamily::reference ? "instants" : "steps measured");
    }
    if (!text.empty()) out += tag("dt", row.name) + tag("dd", text) + "\n";
  }
  return out + "</dl>\n";
}

std::string html(const Trade& trade, const scene::Manifest& manifest) {
  std::string out =
      tag("h1", trade.title) + "\n" +
      tag("p", "Step time and errors of every model, measured on one machine in one run.", "class=\"dim\"") +
      "\n<div class=\"verdict\">\n";
  for (const std::string& sentence : trade_verdict(trade)) out += tag("p", sentence) + "\n";
  out += "</div>\n<div class=\"plots\">\n";
  for (const Judged& one : judged) {
    out += figure(
        one_plot(trade, one, 1000, 560),
        "Down and to the left is better. An error below the reference's uncertainty is drawn at the uncertainty.",
        true);
  }
  out += "</div>\n" + tag("h2", "Every model") + "\n" + table(trade);
  out +=
      tag("p",
          judged_on(trade) +
              " Force: root mean square over the instants, of the peak force. Shape: of the displacement, by area "
              "and over the instants. The number after ± is the reference's uncertainty in the same norm; an error no "
              "larger is not distinguishable from zero. Dominated: another row is no slower (median) and no worse, "
              "and better in one. Steps in contact only, models timed in turn.",
          "class=\"dim\"") +
      "\n" + tag("h2", "Notes on the rows") + "\n" + notes(trade);
  out += manifest_section(manifest,
                          "Beside this page: trade.csv and trade.svg, summary.json (every figure), "
                          "manifest.json.");
  return page(trade.title, out);
}

std::string csv(const Trade& trade) {
  std::string out =
      "key,name,size,step_p50_us,step_p999_us,steps,setup_s,memory_bytes,force_nrmse,force_nrmse_uncertainty,"
      "shape_rel_l2,shape_rel_l2_uncertainty,dominated_force_by,dominated_shape_by,absent\n";
  const auto stands = standing(trade, &TradeRow::name);
  for (std::size_t i = 0; i < trade.rows.size(); ++i) {
    const TradeRow& row = trade.rows[i];
    out += row.key + "," + csv_cell(row.name) + fmt::format(",{},", row.size);
    for (const double value :
         {row.step_p50_us, row.step_p999_us, static_cast<double>(row.steps), row.setup_s, row.memory_bytes,
          row.force_nrmse.value.value_or(NAN), row.force_nrmse.uncertainty.value_or(NAN),
          row.shape_rel_l2.value.value_or(NAN), row.shape_rel_l2.uncertainty.value_or(NAN)}) {
      out += fmt::format("{},", value);
    }
    out += csv_cell(stands[i][0]) + "," + csv_cell(stands[i][1]) + "," + csv_cell(row.absent) + "\n";
  }
  return out;
}

}  // namespace

std::string trade_svg(const Trade& trade) {
  constexpr int width_px = 900, height_px = 520;
  std::vector<std::string> plots;
  for (const Judged& one : judged) plots.push_back(one_plot(trade, one, width_px, height_px));
  return in_rows(trade.title, plots, 1, width_px, height_px);
}

scene::Figures trade_figures(const Trade& trade) {
  scene::Figures out;
  for (const Judged& one : judged) {
    std::string names;
    for (const std::size_t k : pareto_front(trade.rows, one.error)) {
      names += (names.empty() ? "" : ", ") + trade.rows[k].key;
    }
    out.push_back({std::string("trade.front_") + one.what, 0.0, names.empty() ? "none" : names, ""});
  }
  for (const TradeRow& row : trade.rows) {
    const std::string key = "trade." + row.key + ".";
    if (!row.absent.empty()) {
      out.push_back({key + "absent", 0.0, row.absent, ""});
      continue;
    }
    const auto add = [&](const std::string& name, double value, const std::string& unit, const char* why) {
      out.push_back({key + name, value, std::isfinite(value) ? "" : why, unit});
    };
    add("step_us.p50", row.step_p50_us, "us", "not measured");
    add("step_us.p999", row.step_p999_us, "us", "not measured");
    add("setup_s", row.setup_s, "s", "not measured");
    add("memory_bytes", row.memory_bytes, "byte", "not known");
    for (const Judged& one : judged) {
      const Measure& error = row.*one.error;
      add(one.key, error.value.value_or(NAN), "", "not known");
      add(std::string(one.key) + "_uncertainty", error.uncertainty.value_or(NAN), "", "not known");
      const auto by = dominating(trade.rows, one.error)[static_cast<std::size_t>(&row - trade.rows.data())];
      if (by) out.push_back({key + "dominated_" + one.what + "_by", 0.0, trade.rows[*by].key, ""});
    }
  }
  return out;
}

std::string trade_text(const Trade& trade) {
  std::vector<std::vector<std::string>> rows = {{"model", "p50 [us]", "p99.9 [us]", "set-up [s]", "memory [MB]",
                                                 "force [%]", "shape [%]", "dominated by (force | shape)"}};
  const auto stands = standing(trade, &TradeRow::name);
  const auto text = [](double value, int digits = 3) {
    return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : std::string("-");
  };
  const auto error = [&](const Measure& one) {
    if (!one.value) return std::string("-");
    return text(100.0 * *one.value) + (one.distinguishable() ? "" : " ~");
  };
  std::string absent;
  for (std::size_t i = 0; i < trade.rows.size(); ++i) {
    const TradeRow& row = trade.rows[i];
    if (!row.absent.empty()) {
      absent += wrapped("absent: " + row.name + ": " + row.absent) + "\n";
      continue;
    }
    const auto ascii = [&](const std::string& name) { return name == nothing ? std::string("-") : name; };
    rows.push_back({row.name, text(row.step_p50_us), text(row.step_p999_us), text(row.setup_s),
                    text(1e-6 * row.memory_bytes), error(row.force_nrmse), error(row.shape_rel_l2),
                    ascii(stands[i][0]) + " | " + ascii(stands[i][1])});
  }
  std::string out = bench::aligned(rows, true) + absent + "\n";
  for (const std::string& sentence : trade_verdict(trade)) out += wrapped(sentence) + "\n\n";
  return out + judged_on(trade) + " ~: not distinguishable from the reference.\n";
}

void write_trade(const std::filesystem::path& folder, const Trade& trade, const scene::Manifest& manifest) {
  scene::write_file(folder / "trade.csv", csv(trade));
  scene::write_file(folder / "trade.svg", as_file(trade_svg(trade)));
  scene::write_summary(folder / "summary.json", trade_figures(trade));
  scene::write_file(folder / "report.html", html(trade, manifest));
  scene::write_manifest(folder / "manifest.json", manifest);
}

}  // namespace touchstone::compare
