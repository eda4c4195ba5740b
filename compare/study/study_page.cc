#include "compare/study/study_page.h"

#include "compare/errors/figures.h"
#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/headline.h"
#include "compare/report/picture.h"
#include "compare/study/study_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

namespace touchstone::compare {
namespace {

/// A larger ratio of values gets a logarithmic axis.
constexpr double log_ratio = 30.0;

/// A figure that a study shows, and how it is drawn.
struct Quantity {
  std::string_view key, title, y_label;
  double factor;  ///< the figure's unit over the label's
};
constexpr Quantity errors[] = {
    {"force.nrmse", "Force error", "RMS error / largest force [%]", 100.0},
    {"shape.rel_l2", "Shape error", "RMS error / displacement [%]", 100.0},
    {"force.friction_nrmse", "Friction error", "RMS error / largest friction [%]", 100.0},
};
/// Shown in place of errors if the study ran only one solver.
constexpr Quantity of_one_side[] = {
    {"reference.force_uncertainty_rel", "Uncertainty of the reference's force", "of the force [%]", 100.0},
    {"reference.shape_uncertainty_rel", "Uncertainty of the reference's shape", "of the displacement [%]", 100.0},
    {"fast.step_us.p50", "Time of a step, median", "time [µs]", 1.0},
};

/// A quantity of one case, in the unit of its label. NaN: no value.
struct Point {
  double value = no_value;
  double half = no_value;  ///< uncertainty; NaN: not known
  bool has_half = false;   ///< whether the figure has an uncertainty, known or not
  std::string text;        ///< formatted value with the uncertainty
};

Point point_of(const StudyRow& row, const Quantity& quantity) {
  const scene::Figure* figure = find_figure(row.figures, quantity.key);
  if (figure == nullptr || !figure->text.empty()) return {};
  Point out;
  if (!std::isfinite(figure->number)) {
    out.text = figure_text(*figure);
    return out;
  }
  out.value = quantity.factor * std::abs(figure->number);
  out.text = figure_text(*figure);
  const scene::Figure* half = find_figure(row.figures, std::string(quantity.key) + std::string(uncertainty_suffix));
  if (half != nullptr) {
    out.has_half = true;
    out.half = quantity.factor * half->number;
    out.text += " ± " + (std::isfinite(half->number) ? figure_text(*half) : "unknown");
  }
  return out;
}

/// The values of one quantity for all cases.
struct Series {
  const Quantity& quantity;
  std::vector<Point> points;  ///< by case

  Series(const std::vector<StudyRow>& rows, const Quantity& of) : quantity(of) {
    for (const StudyRow& row : rows) points.push_back(point_of(row, of));
  }
  [[nodiscard]] bool empty() const {
    return std::none_of(points.begin(), points.end(), [](const Point& p) { return std::isfinite(p.value); });
  }
  [[nodiscard]] bool any_unknown() const {
    return std::any_of(points.begin(), points.end(),
                       [](const Point& p) { return p.has_half && std::isfinite(p.value) && !std::isfinite(p.half); });
  }
  [[nodiscard]] bool any_half() const {
    return std::any_of(points.begin(), points.end(),
                       [](const Point& p) { return std::isfinite(p.value) && std::isfinite(p.half); });
  }
  /// Explains the error bars and markers.
  [[nodiscard]] std::string note() const {
    std::string out;
    if (any_half()) {
      out = "Bars: the reference's own uncertainty; where none is seen it is smaller than the mark.";
    }
    if (any_unknown()) out += (out.empty() ? "" : " ") + std::string("Hollow marks: its uncertainty is unknown.");
    return out;
  }
};

bool spans_decades(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    if (v <= 0.0) return false;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return high >= log_ratio * low;
}

/// One line for every combination of the other parameters. @param drawn  which cases to draw
Plot line_plot(const Series& series, const std::vector<StudyParameter>& parameters, std::size_t along,
               const std::vector<bool>& drawn) {
  const StudyParameter& x = parameters[along];
  std::vector<std::string> names;  // names of the lines, in the study's order
  std::map<std::string, std::vector<std::size_t>> lines;
  for (std::size_t k = 0; k < series.points.size(); ++k) {
    if (!drawn[k] || !std::isfinite(x.numbers[k]) || !std::isfinite(series.points[k].value)) continue;
    std::string name;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (p == along || parameters[p].values[k].empty()) continue;
      name += (name.empty() ? "" : ", ") + parameters[p].shown + " = " + parameters[p].values[k] +
              (parameters[p].unit.empty() ? "" : " " + parameters[p].unit);
    }
    if (lines[name].empty()) names.push_back(name);
    lines[name].push_back(k);
  }
  Plot plot;
  plot.title = std::string(series.quantity.title) + " over " + x.shown;
  plot.x_label = x.label();
  plot.y_label = series.quantity.y_label;
  plot.x_log = spans_decades(x.numbers);
  std::vector<double> values;
  for (const Point& point : series.points) values.push_back(point.value);
  plot.y_log = spans_decades(values);
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<std::size_t>& cases = lines[names[i]];
    std::stable_sort(cases.begin(), cases.end(),
                     [&](std::size_t a, std::size_t b) { return x.numbers[a] < x.numbers[b]; });
    Curve curve{names[i], i < palette.size() ? Look::first : Look::second, {}, {}};
    curve.own_colour = palette[i % palette.size()];
    for (const std::size_t k : cases) {
      curve.x.push_back(x.numbers[k]);
      curve.y.push_back(series.points[k].value);
      if (series.points[k].has_half) curve.y_half.push_back(series.points[k].half);
    }
    if (curve.y_half.size() != curve.y.size()) curve.y_half.clear();
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// Dark or light text, whichever is readable on the colour.
const char* ink_on(const std::array<int, 3>& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2] > 110.0 ? "#1c1e21" : "#ffffff";
}

std::array<int, 3> colour_at(double share) {
  const auto& steps = colour_table(ColourMap::error);
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(steps.size() - 1);
  return steps[static_cast<std::size_t>(std::lround(at))];
}

/// Two parameters against each other; each cell shows the value and its colour.
std::string heat_table(const Series& series, const StudyParameter& across, const StudyParameter& down,
                       const std::vector<bool>& drawn) {
  double largest = 0.0;
  for (const Point& point : series.points) largest = std::max(largest, std::isfinite(point.value) ? point.value : 0.0);
  const auto name_of = [](const StudyParameter& parameter, const std::string& value) {
    return parameter.unit.empty() ? value : value + std::string(no_break) + parameter.unit;
  };
  const std::vector<std::string> columns = across.distinct();
  std::string out = "<div class=\"scroll\"><table>\n<tr>" + tag("th", down.shown + " ↓  " + across.shown + " →");
  for (const std::string& column : columns) out += tag("th", name_of(across, column), "class=\"n\"");
  out += "</tr>\n";
  for (const std::string& row : down.distinct()) {
    out += "<tr>" + tag("th", name_of(down, row));
    for (const std::string& column : columns) {
      std::string text = "–", style;
      for (std::size_t k = 0; k < series.points.size(); ++k) {
        if (!drawn[k] || across.values[k] != column || down.values[k] != row || series.points[k].text.empty()) continue;
        text = series.points[k].text;
        if (!std::isfinite(series.points[k].value)) continue;
        // From light to dark; the lightest fifth is not used, to differ from the page.
        const auto rgb = colour_at(largest > 0.0 ? 0.12 + 0.7 * series.points[k].value / largest : 0.12);
        style = fmt::format(
            "class=\"n\" style=\"background:rgb({},{},{});color:{};padding-left:.7rem;"
            "print-color-adjust:exact\"",
            rgb[0], rgb[1], rgb[2], ink_on(rgb));
        break;
      }
      out += tag("td", text, style.empty() ? "class=\"n\"" : style);
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n" + tag("p", "Colour: from zero, light, to the largest, dark.", "class=\"dim\"") + "\n";
}

/// One row per case: name, marker with error bar on a common scale from zero, and number.
std::string rows_by_case(const Series& series, const std::vector<StudyRow>& rows) {
  constexpr double width_px = 300.0, edge_px = 6.0, height_px = 18.0;
  double largest = 0.0;
  for (const Point& p : series.points) {
    if (std::isfinite(p.value)) largest = std::max(largest, p.value + (std::isfinite(p.half) ? p.half : 0.0));
  }
  const auto px = [&](double value) {
    return edge_px + (largest > 0.0 ? std::clamp(value / largest, 0.0, 1.0) : 0.0) * (width_px - 2.0 * edge_px);
  };
  std::string out = "<div class=\"scroll\"><table>\n<tr><th>Case</th>" +
                    tag("th", fmt::format("0 to {} {}", number_text(largest), series.quantity.y_label)) +
                    "<th class=\"n\">Value</th></tr>\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Point& p = series.points[k];
    out += "<tr>" + tag("td", rows[k].one->name) + "<td style=\"min-width:9rem\">";
    if (std::isfinite(p.value)) {
      const double middle = 0.5 * height_px;
      out += fmt::format(
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\""
          " role=\"img\"><title>{2}</title><line x1=\"{3}\" y1=\"{4}\" x2=\"{5:.1f}\" y2=\"{4}\" "
          "stroke=\"currentColor\" stroke-opacity=\"0.3\"/>",
          width_px, height_px, escape_xml(p.text), edge_px, middle, px(p.value));
      if (std::isfinite(p.half)) {
        out += fmt::format("<line x1=\"{:.1f}\" y1=\"{}\" x2=\"{:.1f}\" y2=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>",
                           px(p.value - p.half), middle, px(p.value + p.half), middle, palette[0]);
      }
      const bool hollow = p.has_half && !std::isfinite(p.half);
      out +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{}\" r=\"4\" fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/></svg>",
                      px(p.value), middle, hollow ? "none" : palette[0], palette[0]);
    }
    out += "</td>" + number_cell(p.text.empty() ? state_name(rows[k].status.state) : p.text) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

/// Whether most pairs have a value and a table would not be too large.
bool makes_a_table(const std::vector<StudyParameter>& parameters) {
  if (parameters.size() != 2) return false;
  const std::size_t across = parameters[0].distinct().size(), down = parameters[1].distinct().size();
  std::set<std::pair<std::string, std::string>> there;
  for (std::size_t k = 0; k < parameters[0].values.size(); ++k) {
    if (parameters[0].values[k].empty() || parameters[1].values[k].empty()) continue;
    there.emplace(parameters[0].values[k], parameters[1].values[k]);
  }
  return across > 1 && down > 1 && 2 * there.size() > across * down;
}

std::string quantity_section(const Series& series, const std::vector<StudyParameter>& all,
                             const std::vector<StudyRow>& rows) {
  constexpr std::size_t lines_with_names = 8;
  // Cases that are not on the axes are not points of the lines.
  std::vector<StudyParameter> parameters = all;
  const bool has_axes = std::any_of(all.begin(), all.end(), [](const StudyParameter& one) { return one.axis; });
  if (has_axes) std::erase_if(parameters, [](const StudyParameter& one) { return !one.axis; });
  std::vector<bool> drawn;
  for (const StudyRow& row : rows) drawn.push_back(!has_axes || !row.one->along.empty());

  std::string plots;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!parameters[p].numeric()) continue;
    Plot plot = line_plot(series, parameters, p, drawn);
    if (std::none_of(plot.curves.begin(), plot.curves.end(), [](const Curve& c) { return c.x.size() > 1; })) continue;
    std::string note = series.note();
    if (plot.curves.size() > lines_with_names) {
      for (Curve& curve : plot.curves) curve.name.clear();
      note = fmt::format("{} lines, one for each combination of the other parameters. {}", plot.curves.size(), note);
    }
    plots += figure(to_svg(plot, 560, 380), note);
  }
  std::string out = tag("h2", std::string(series.quantity.title)) + "\n";
  if (!plots.empty()) out += "<div class=\"plots\">\n" + plots + "</div>\n";
  if (makes_a_table(parameters)) {
    const bool first_is_longer = parameters[0].distinct().size() >= parameters[1].distinct().size();
    out += heat_table(series, parameters[first_is_longer ? 0 : 1], parameters[first_is_longer ? 1 : 0], drawn);
  }
  const bool all_drawn = std::all_of(drawn.begin(), drawn.end(), [](bool one) { return one; });
  if (!all_drawn || (plots.empty() && !makes_a_table(parameters))) {
    out += rows_by_case(series, rows) + (plots.empty() ? tag("p", series.note(), "class=\"dim\"") + "\n" : "");
  }
  return out;
}

/// Smallest and largest value of a quantity, and the cases in which its uncertainty is unknown.
std::string range_sentence(const Series& series, const std::vector<StudyRow>& rows) {
  std::optional<std::size_t> least, most;
  int unknown = 0, values = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Point& p = series.points[k];
    if (!std::isfinite(p.value)) continue;
    ++values;
    if (p.has_half && !std::isfinite(p.half)) ++unknown;
    if (!least || p.value < series.points[*least].value) least = k;
    if (!most || p.value > series.points[*most].value) most = k;
  }
  const std::string what(series.quantity.title);
  std::string out = least == most
                        ? fmt::format("{}: {} ({}).", what, series.points[*most].text, rows[*most].one->name)
                        : fmt::format("{}: from {} ({}) to {} ({}).", what, series.points[*least].text,
                                      rows[*least].one->name, series.points[*most].text, rows[*most].one->name);
  if (unknown > 0) {
    out += unknown == values
               ? " The reference's uncertainty is unknown in every case."
               : fmt::format(" The reference's uncertainty is unknown in {} of {} cases.", unknown, values);
  }
  return out;
}

std::string case_table(const StudyManifest& manifest, const std::vector<StudyParameter>& parameters,
                       const std::vector<StudyRow>& rows) {
  std::string out = tag("h2", "Cases") + "\n<div class=\"scroll\"><table>\n<tr><th>Case</th>";
  for (const StudyParameter& parameter : parameters) {
    out += tag("th", parameter.label(),
               fmt::format("title=\"{}\"{}", escape_xml(parameter.name), parameter.numeric() ? " class=\"wrap\"" : ""));
  }
  out += headline_heads() + "</tr>\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const StudyRow& row = rows[k];
    const std::string report = "results/" + row.one->id + "/report.html";
    const bool linked = std::filesystem::exists(manifest.folder / report);
    const std::string name = fmt::format("{}. {}", row.one->index, row.one->name);
    out += "<tr><td>" + (linked ? tag("a", name, fmt::format("href=\"{}\"", report)) : escape_xml(name)) + "</td>";
    for (const StudyParameter& parameter : parameters) {
      const std::string& value = parameter.values[k];
      out += parameter.numeric() ? number_cell(value.empty() ? "–" : value) : cell(value.empty() ? "–" : value);
    }
    if (row.status.state == CaseState::done) {
      out += headline_cells(row.figures);
    } else {
      out +=
          tag("td", std::string(state_name(row.status.state)) + (row.status.why.empty() ? "" : ": " + row.status.why),
              "colspan=\"8\"");
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n" + headline_note();
}

std::string pictures_section(const StudyManifest& manifest, const std::vector<StudyRow>& rows) {
  std::string pictures;
  for (const StudyRow& row : rows) {
    const std::string folder = "results/" + row.one->id + "/";
    if (row.status.state != CaseState::done || !std::filesystem::exists(manifest.folder / (folder + "shape.svg"))) {
      continue;
    }
    pictures += fmt::format(
        "<figure><a href=\"{0}report.html\"><img src=\"{0}shape.svg\" alt=\"{1}\" loading=\"lazy\"/></a>{2}</figure>\n",
        folder, escape_xml("Deformed bodies and error: " + row.one->name), tag("figcaption", row.one->name));
  }
  if (pictures.empty()) return "";
  return tag("h2", "Shape at the deepest instant") + "\n" +
         tag("p", "Reference, fast model, and the error between them; each opens its report.", "class=\"dim\"") +
         "\n<div class=\"plots\">\n" + pictures + "</div>\n";
}

std::string origin_section(const StudyManifest& manifest, const std::vector<StudyRow>& rows) {
  std::set<std::string> versions;
  for (const StudyRow& row : rows) {
    if (row.status.state == CaseState::done) versions.insert(row.status.version);
  }
  std::string all;
  for (const std::string& version : versions) all += (all.empty() ? "" : "; ") + version;
  std::string out = tag("h2", "How this was made") + "\n";
  out +=
      tag("p", fmt::format("Study {}, every case run as \"touchstone {}\" on its resolved scene in scenes/. The same "
                           "table with every figure is in summary.csv and summary.json.",
                           manifest.name, manifest.run)) +
      "\n";
  if (!all.empty()) out += tag("p", "Version: " + all) + "\n";
  if (versions.size() > 1) out += tag("p", "The cases are of different versions of the program.") + "\n";
  return out;
}

}  // namespace

std::string study_page_html(const StudyManifest& manifest, const std::vector<StudyRow>& rows) {
  const std::string title = manifest.title.empty() ? manifest.name : manifest.title;
  const std::vector<StudyParameter> parameters = study_parameters(manifest);
  std::vector<Series> drawn;
  const auto take = [&](const auto& quantities) {
    for (const Quantity& quantity : quantities) {
      if (Series series(rows, quantity); !series.empty()) drawn.push_back(std::move(series));
    }
  };
  take(errors);
  if (drawn.empty()) take(of_one_side);
  const auto done =
      std::count_if(rows.begin(), rows.end(), [](const StudyRow& row) { return row.status.state == CaseState::done; });
  std::string varies;
  for (const StudyParameter& parameter : parameters) varies += (varies.empty() ? "" : ", ") + parameter.shown;
  std::string out =
      tag("h1", title) + "\n" +
      tag("p",
          fmt::format("{} of {} cases done{}.", done, rows.size(), varies.empty() ? "" : "; what varies: " + varies),
          "class=\"dim\"") +
      "\n<div class=\"verdict\">\n";
  for (const Series& series : drawn) out += tag("p", range_sentence(series, rows)) + "\n";
  out += "</div>\n";
  for (const Series& series : drawn) out += quantity_section(series, parameters, rows);
  out += case_table(manifest, parameters, rows) + pictures_section(manifest, rows) + origin_section(manifest, rows);
  return page(title, out);
}

}  // namespace touchstone::compare
