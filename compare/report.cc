#include "compare/report.h"

#include "compare/figures.h"
#include "compare/page.h"
#include "compare/picture.h"
#include "compare/svg_plot.h"
#include "compare/text.h"
#include "compare/verdict.h"
#include "compare/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// One number per instant; NaN where there is none, which a plot leaves out.
template <class Get>
std::vector<double> series(const Errors& errors, const Get& get) {
  std::vector<double> out;
  for (const InstantErrors& e : errors.instants) out.push_back(get(e));
  return out;
}

std::vector<double> depths_mm(const Errors& errors) {
  return series(errors, [](const InstantErrors& e) { return 1e3 * e.depth_m; });
}

/// Force of both sides with the reference's band, over depth or time.
Plot force_plot(const Errors& errors, const std::string& title, const std::string& x_label,
                const std::vector<double>& x) {
  Plot plot;
  plot.title = title;
  plot.x_label = x_label;
  plot.y_label = "force on the tool [N]";
  Band band{"reference's uncertainty", Look::reference, x, {}, {}};
  for (const InstantErrors& e : errors.instants) {
    band.low.push_back(std::max(0.0, e.force_reference_n - e.force_uncertainty_n));
    band.high.push_back(e.force_reference_n + e.force_uncertainty_n);
  }
  plot.bands.push_back(std::move(band));
  plot.curves.push_back(
      {"reference", Look::reference, x, series(errors, [](const InstantErrors& e) { return e.force_reference_n; })});
  plot.curves.push_back(
      {"fast model", Look::fast, x, series(errors, [](const InstantErrors& e) { return e.force_fast_n; })});
  return plot;
}

/// Friction of both sides over the tool's way along the surface.
Plot friction_plot(const Errors& errors) {
  Plot plot;
  plot.title = "Friction over the way";
  plot.x_label = "way of the tool at the contact [mm]";
  plot.y_label = "friction on the tool [N]";
  const std::vector<double> way_mm = series(errors, [](const InstantErrors& e) { return 1e3 * e.way_m; });
  plot.curves.push_back({"reference", Look::reference, way_mm,
                         series(errors, [](const InstantErrors& e) { return e.friction_reference_n; })});
  plot.curves.push_back(
      {"fast model", Look::fast, way_mm, series(errors, [](const InstantErrors& e) { return e.friction_fast_n; })});
  return plot;
}

/// Where each side begins to slide.
std::string slip_note(const Errors& errors) {
  const auto begins = [](const std::string& side, const std::optional<double>& way_m) {
    return side + (way_m ? " slides from " + quantity_text(*way_m, "m") + " on" : " never slides");
  };
  return begins("The fast model", errors.slip_onset_fast_m) + ", " +
         begins("the reference", errors.slip_onset_reference_m) + ".";
}

/// An error in percent with the reference's uncertainty in the same norm, over depth. Logarithmic where the
/// sizes differ too much for one linear axis.
Plot error_plot(const Errors& errors, const std::string& title, const std::string& y_label,
                const std::vector<double>& error, const std::vector<double>& uncertainty) {
  Plot plot;
  plot.title = title;
  plot.x_label = "depth [mm]";
  plot.y_label = y_label;
  plot.curves.push_back({"fast model's error", Look::fast, depths_mm(errors), error});
  plot.curves.push_back({"reference's own uncertainty", Look::reference, depths_mm(errors), uncertainty});
  const auto largest = [](const std::vector<double>& values) {
    double found = 0.0;
    for (const double v : values) found = std::max(found, std::isfinite(v) ? v : 0.0);
    return found;
  };
  plot.y_log = largest(uncertainty) > 0.0 && largest(error) > 20.0 * largest(uncertainty);
  return plot;
}

std::string measure_note(const Measure& measure) {
  if (!measure.value) return "no contact to relate it to";
  if (!measure.uncertainty) return "the reference's uncertainty is unknown";
  return fmt::format("the reference is good to {}{}", percent_text(*measure.uncertainty),
                     measure.distinguishable() ? "" : ": not distinguishable");
}

std::string head_section(const ReportContent& c) {
  std::string out = tag("h1", scene_title(c.scene)) + "\n";
  out += tag("p", "How far the fast contact model is from the finite-element reference, in force and in shape.",
             "class=\"dim\"") +
         "\n<div class=\"verdict\">\n";
  for (const std::string& paragraph : verdict(c.scene, c.run, c.result, c.errors)) out += tag("p", paragraph) + "\n";
  const InstantErrors& deepest = c.errors.instants[c.errors.deepest];
  out += "</div>\n<div class=\"tiles\">\n";
  out += tile(fmt::format("Force at {} depth", quantity_text(deepest.depth_m, "m")),
              fmt::format("{} : {}", number_text(deepest.force_fast_n), quantity_text(deepest.force_reference_n, "N")),
              "fast model : reference");
  out += tile("Force error, of the peak", quantity_text(c.errors.force_nrmse.value, "", "–"),
              measure_note(c.errors.force_nrmse));
  out += tile("Shape error, of the displacement", quantity_text(c.errors.shape_rel_l2.value, "", "–"),
              measure_note(c.errors.shape_rel_l2));
  out += tile("One step of the fast model", quantity_text(c.run.step.p50_us, "us"),
              fmt::format("median; longest {}", quantity_text(c.run.step.max_us, "us")));
  return out + "</div>\n";
}

std::string words_section() {
  return R"(<details>
<summary>Words used on this page</summary>
<dl>
<dt>Tool, body, depth</dt><dd>A rigid tool is moved along a given track into an elastic body. Depth is how far the
tool reaches below the body's undeformed surface; it is the same for both sides at every instant.</dd>
<dt class="fast">Fast model</dt><dd>The real-time model of a haptic display: a contact law for the force and a skeleton
of beams for the shape, some microseconds per step.</dd>
<dt class="reference">Reference</dt><dd>An offline finite-element solution of the same scene on several meshes, each
finer than the one before. Its uncertainty is the half width of the band in which the exact solution is expected.</dd>
<dt>Force</dt><dd>What the body exerts on the tool.</dd>
<dt>Shape</dt><dd>The displacement of every point of the body's surface from where it was at rest. Errors are taken
point by point at the same instant and the same rest point.</dd>
<dt>Not distinguishable</dt><dd>The error is no larger than the reference's own uncertainty, so it may be none.</dd>
</dl>
</details>
)";
}

std::string force_section(const ReportContent& c) {
  const Errors& errors = c.errors;
  const std::vector<double> depth_mm = depths_mm(errors);
  const std::vector<double> time_s = series(errors, [](const InstantErrors& e) { return e.time_s; });
  Plot over_depth = force_plot(errors, "Force over depth", "depth [mm]", depth_mm);
  Plot both_logarithmic = over_depth;
  both_logarithmic.title = "The same, both axes logarithmic";
  both_logarithmic.x_log = both_logarithmic.y_log = true;
  // A grazing instant's rounding would take most of the decades.
  for (Curve& curve : both_logarithmic.curves) {
    for (std::size_t t = 0; t < curve.y.size(); ++t) {
      if (!errors.instants[t].in_contact) curve.y[t] = no_value;
    }
  }
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    if (!errors.instants[t].in_contact) both_logarithmic.bands[0].high[t] = no_value;
  }
  const Plot relative =
      error_plot(errors, "Relative force error over depth", "|difference| / reference [%]",
                 series(errors, [](const InstantErrors& e) { return 100.0 * e.force_error_rel.value_or(no_value); }),
                 series(errors, [](const InstantErrors& e) {
                   return e.force_error_rel ? 100.0 * e.force_uncertainty_n / e.force_reference_n : no_value;
                 }));
  std::string out = tag("h2", "Force") + "\n<div class=\"plots\">\n";
  out += figure(to_svg(over_depth), "Where the band is not seen, it is narrower than the line.");
  out += figure(to_svg(both_logarithmic),
                "A power law is a straight line here, and a small force is not lost beside a large one.");
  out += figure(to_svg(force_plot(errors, "Force over time", "time [s]", time_s)), "");
  if (errors.friction) out += figure(to_svg(friction_plot(errors)), slip_note(errors));
  out += figure(to_svg(relative), "Relative to the reference's force at the same instant.");
  return out + "</div>\n";
}

std::string shape_section(const ReportContent& c) {
  const Errors& errors = c.errors;
  const InstantErrors& deepest = errors.instants[errors.deepest];
  std::string out = tag("h2", "Shape") + "\n" + viewer_section(c.scene, c.run, c.result, errors);
  out +=
      figure(half_cut_svg(c.scene, c.run, c.result, errors.deepest),
             fmt::format("Both bodies at the deepest instant ({}, {} deep), cut in half at the tool's centre; the grey "
                         "shape is the tool's cut. True proportions, displacements not exaggerated.",
                         quantity_text(deepest.time_s, "s"), quantity_text(deepest.depth_m, "m")));
  out += "<div class=\"plots\">\n";
  out += figure(section_svg(c.scene, c.run, c.result, errors.deepest, false),
                "Where the cut plane of the rest body has gone; true scale.");
  out +=
      figure(section_svg(c.scene, c.run, c.result, errors.deepest, true),
             "A surface should lie on the tool where they touch, and nowhere inside it. The reference is drawn on its "
             "own mesh, dots are its nodes in this plane; the fast model is straight between its own points, the "
             "squares.");
  out +=
      figure(to_svg(error_plot(
                 errors, "Shape error over depth", "error / displacement, RMS [%]",
                 series(errors, [](const InstantErrors& e) { return 100.0 * e.shape_rel_l2.value.value_or(no_value); }),
                 series(errors,
                        [](const InstantErrors& e) { return 100.0 * e.shape_rel_l2.uncertainty.value_or(no_value); }))),
             "Over the whole surface, weighted by area.");
  Plot largest;
  largest.title = "Largest shape error over depth";
  largest.x_label = "depth [mm]";
  largest.y_label = "distance [mm]";
  largest.curves.push_back({"of one point from its true place", Look::fast, depths_mm(errors),
                            series(errors, [](const InstantErrors& e) { return 1e3 * e.shape_max_m; })});
  largest.curves.push_back({"between the two surfaces", Look::plain, depths_mm(errors),
                            series(errors, [](const InstantErrors& e) { return 1e3 * e.hausdorff_m; })});
  out += figure(to_svg(largest),
                "Points may slide along the surface unseen: then the surfaces are nearer than the points.");
  return out + "</div>\n";
}

std::string instants_table(const ReportContent& c) {
  std::string out =
      "<details>\n<summary>Every instant in numbers</summary>\n<div class=\"scroll\"><table>\n<tr><th class=\"n\">time"
      "</th><th class=\"n\">depth</th><th class=\"n\">force, fast</th><th class=\"n\">force, reference</th><th "
      "class=\"n\">± </th><th class=\"n\">error</th><th class=\"n\">shape error</th><th class=\"n\">largest</th><th "
      "class=\"n\">area in common</th></tr>\n";
  for (const InstantErrors& e : c.errors.instants) {
    out += "<tr>" + number_cell(number_text(e.time_s) + " s") + number_cell(quantity_text(e.depth_m, "m")) +
           number_cell(quantity_text(e.force_fast_n, "N")) + number_cell(quantity_text(e.force_reference_n, "N")) +
           number_cell(std::isfinite(e.force_uncertainty_n) ? quantity_text(e.force_uncertainty_n, "N") : "unknown") +
           number_cell(quantity_text(e.force_error_rel, "", "–")) +
           number_cell(quantity_text(e.shape_rel_l2.value, "", "–")) + number_cell(quantity_text(e.shape_max_m, "m")) +
           number_cell(quantity_text(e.contact_area_iou, "", "–")) + "</tr>\n";
  }
  return out + "</table></div>\n</details>\n";
}

/// What a reader should know about an error beside its number.
std::string remark(const scene::Figure& value, const scene::Figure* uncertainty) {
  if (uncertainty == nullptr || !value.text.empty()) return "";
  if (!uncertainty->text.empty()) return "";
  return std::abs(value.number) <= uncertainty->number ? "not distinguishable" : "";
}

std::string figures_section(const ReportContent& c) {
  constexpr std::pair<std::string_view, std::string_view> groups[] = {{"force.", "Force"},
                                                                      {"shape.", "Shape"},
                                                                      {"contact.", "Contact"},
                                                                      {"reference.", "How good the reference is"},
                                                                      {"fast.", "What the fast model costs"}};
  std::string out =
      tag("h2", "All figures") +
      "\n<div class=\"scroll\"><table>\n<tr><th>Figure and its key in summary.json</th><th class=\"n\">Value"
      "</th><th class=\"n\">Reference’s own uncertainty</th><th></th></tr>\n";
  for (const auto& [prefix, name] : groups) {
    out += fmt::format("<tr class=\"group\"><th colspan=\"4\">{}</th></tr>\n", name);
    for (const scene::Figure& figure : c.figures) {
      if (!figure.key.starts_with(prefix) || figure.key.ends_with(uncertainty_suffix)) continue;
      const std::string partner_key = figure.key + std::string(uncertainty_suffix);
      const auto partner = std::find_if(c.figures.begin(), c.figures.end(),
                                        [&](const scene::Figure& f) { return f.key == partner_key; });
      const bool paired = partner != c.figures.end();
      out += fmt::format(
          "<tr><td>{}<br/>{}</td>{}<td class=\"n\">{}{}</td>{}</tr>\n", escape_xml(figure_meaning(figure.key)),
          tag("code", figure.key), tag("td", figure_text(figure), figure.text.empty() ? "class=\"n\"" : "class=\"t\""),
          paired ? escape_xml(figure_text(*partner)) + "<br/>" : "",
          paired ? tag("code", "…" + std::string(uncertainty_suffix), fmt::format("title=\"{}\"", partner_key)) : "",
          cell(remark(figure, paired ? &*partner : nullptr)));
    }
  }
  return out + "</table></div>\n";
}

std::string reference_section(const ReportContent& c) {
  std::string out = tag("h2", "How the reference was refined") + "\n";
  out +=
      tag("p", fmt::format("Model: {}. Linear solver: {}.{}", c.result.model, c.result.linear_solver,
                           c.result.from_store ? " Read from the store of earlier solutions; times are those of "
                                                 "the original solve."
                                               : "")) +
      "\n<div class=\"scroll\"><table>\n<tr><th class=\"n\">level</th><th class=\"n\">element size at the contact</th>"
      "<th class=\"n\">unknowns</th><th class=\"n\">force at the deepest instant</th><th class=\"n\">change</th><th "
      "class=\"n\">Newton iterations</th><th class=\"n\">load steps halved</th><th class=\"n\">time</th></tr>\n";
  double before_n = no_value;
  for (std::size_t i = 0; i < c.result.levels.size(); ++i) {
    const reference::LevelRecord& level = c.result.levels[i];
    const double force_n = level.force_n.size() > c.errors.deepest ? level.force_n[c.errors.deepest] : no_value;
    out += "<tr>" + number_cell(std::to_string(i + 1)) + number_cell(quantity_text(level.element_size_m, "m")) +
           number_cell(number_text(level.unknowns)) + number_cell(fmt::format("{} N", number_text(force_n, 5))) +
           number_cell(std::isfinite(before_n) && before_n > 0.0 ? percent_text(force_n / before_n - 1.0) : "–") +
           number_cell(number_text(level.newton_iterations)) + number_cell(number_text(level.steps_cut)) +
           number_cell(quantity_text(level.wall_s, "s")) + "</tr>\n";
    before_n = force_n;
  }
  return out + "</table></div>\n";
}

}  // namespace

std::string report_html(const ReportContent& c) {
  std::string out = head_section(c) + words_section() + force_section(c) + shape_section(c) + instants_table(c) +
                    figures_section(c) + reference_section(c);
  out += tag("h2", "What each side models of the scene") + "\n";
  out += tag("h3", "Fast model", "class=\"fast\"") + plan_table(c.plans.fast);
  out += tag("h3", "Reference", "class=\"reference\"") + plan_table(c.plans.reference);
  out += manifest_section(
      c.manifest,
      "Beside this page: summary.json (these figures), curve.csv (every instant), shape.svg, manifest.json, and "
      "surface.pvd for ParaView, where the filter Warp By Vector with displacement_fast_m or "
      "displacement_reference_m shows a side.");
  return page(scene_title(c.scene), out);
}

void write_report(const std::filesystem::path& path, const ReportContent& content) {
  scene::write_file(path, report_html(content));
}

}  // namespace touchstone::compare
