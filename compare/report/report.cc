#include "compare/report/report.h"

#include "compare/errors/figures.h"
#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::compare {
namespace {

std::string measure_note(const Measure& measure) {
  if (!measure.value) return "undefined without contact";
  if (!measure.uncertainty) return "the reference's uncertainty is unknown";
  return fmt::format("± {}, the reference's own{}", percent_text(*measure.uncertainty),
                     measure.distinguishable() ? "" : ": not distinguishable");
}

/// The value of a figure, or a dash if it is undefined.
std::string measure_text(const Measure& measure) { return quantity_text(measure.value, "", "–"); }

std::string tiles(const ReportContent& c) {
  const InstantErrors& deepest = c.errors.instants[c.errors.deepest];
  std::string out = "<div class=\"tiles\">\n";
  out += tile(fmt::format("Force at {} depth", quantity_text(deepest.depth_m, "m")),
              quantity_text(deepest.force_fast_n, "N"),
              "fast model; reference " + quantity_text(deepest.force_reference_n, "N"));
  out += tile("Force error, of the peak", measure_text(c.errors.force_nrmse), measure_note(c.errors.force_nrmse));
  out += tile("Shape error, of the displacement", measure_text(c.errors.shape_rel_l2),
              c.errors.shape_rel_l2.value.value_or(0.0) > 1.0 ? "worse than no deformation, which is 100 %"
                                                              : measure_note(c.errors.shape_rel_l2));
  out += tile("One step of the fast model", quantity_text(c.run.step.p50_us, "us"),
              fmt::format("median; longest {}", quantity_text(c.run.step.max_us, "us")));
  const std::size_t meshes = c.result.levels.size();
  const std::optional<double> force = force_known_to(c.errors), shape = c.errors.shape_rel_l2.uncertainty;
  out += tile(
      "Reference's uncertainty", quantity_text(force, "", "unknown"),
      fmt::format("{}{} mesh{}, {} unknowns",
                  force ? "of the force at the worst instant; shape " + quantity_text(shape, "", "unknown") + "; " : "",
                  meshes, meshes == 1 ? "" : "es", number_text(meshes == 0 ? 0.0 : c.result.levels.back().unknowns)));
  return out + "</div>\n";
}

/// The command that made the page; empty if the manifest does not have it.
std::string command_line(const scene::Manifest& manifest) {
  const auto typed = std::find_if(manifest.entries.begin(), manifest.entries.end(),
                                  [](const auto& entry) { return entry.first == "command_line"; });
  if (typed == manifest.entries.end()) return "";
  return "<p class=\"command\">" + tag("code", typed->second) + "</p>\n";
}

std::string figures_of(const std::vector<Drawing>& drawings) {
  std::string out;
  for (const Drawing& drawing : drawings) out += figure(drawing.svg, drawing.caption, drawing.wide);
  return out;
}

/// The top of the page: numbers, two sentences, the force and both bodies.
std::string first_screen(const ReportContent& c) {
  std::string out = tiles(c);
  if (!c.models.empty()) out += model_table_html(c.models);
  out += tag("p", c.verdict.force + (c.verdict.shape.empty() ? "" : " " + c.verdict.shape), "class=\"lead\"") + "\n";
  out += "<div class=\"first\">\n<div>\n" + figures_of({c.drawings.force, c.drawings.shape_error}) + "</div>\n<div>\n" +
         viewer_section(c.scene, c.run, c.result, c.errors) + "</div>\n</div>\n";
  const InstantErrors& deepest = c.errors.instants[c.errors.deepest];
  out += "<figure>\n<div class=\"bodies\">\n";
  for (const Drawing& body : c.drawings.bodies) out += body.svg;
  return out + "</div>\n" +
         tag("figcaption",
             fmt::format("Both bodies at the deepest instant ({}, {} deep), cut in half at the tool's centre; the grey "
                         "shape is the tool's cut. True proportions, displacements not exaggerated.",
                         quantity_text(deepest.time_s, "s"), quantity_text(deepest.depth_m, "m"))) +
         "\n</figure>\n";
}

Section why_section(const ReportContent& c) {
  std::string out;
  for (const Reason& reason : c.verdict.reasons) {
    out += "<p>" + tag("b", reason.about + ":") + " " + escape_xml(reason.text()) + "</p>\n";
  }
  return {"Why", out};
}

Section next_section(const ReportContent& c) {
  std::string out;
  for (const NextStep& step : c.verdict.next) {
    out += tag("p", step.why) + "\n";
    if (!step.command.empty()) out += tag("pre", step.command) + "\n";
  }
  return {"What to do next", out};
}

Section words_section() {
  return {"Words", R"(<dl>
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
)",
          true};
}

Section instants_section(const ReportContent& c) {
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th class=\"n\">time"
      "</th><th class=\"n\">depth</th><th class=\"n\">force, fast</th><th class=\"n\">force, reference</th><th "
      "class=\"n\">uncertainty</th><th class=\"n\">error</th><th class=\"n\">shape error</th><th "
      "class=\"n\">largest</th><th "
      "class=\"n\">area in common</th></tr>\n";
  for (const InstantErrors& e : c.errors.instants) {
    out += "<tr>" + number_cell(number_text(e.time_s) + " s") + number_cell(quantity_text(e.depth_m, "m")) +
           number_cell(quantity_text(e.force_fast_n, "N")) + number_cell(quantity_text(e.force_reference_n, "N")) +
           number_cell(std::isfinite(e.force_uncertainty_n) ? quantity_text(e.force_uncertainty_n, "N") : "unknown") +
           number_cell(quantity_text(e.force_error_rel, "", "–")) +
           number_cell(quantity_text(e.shape_rel_l2.value, "", "–")) + number_cell(quantity_text(e.shape_max_m, "m")) +
           number_cell(quantity_text(e.contact_area_iou, "", "–")) + "</tr>\n";
  }
  return {"Every instant", out + "</table></div>\n", true};
}

/// Note beside an error: whether it is distinguishable from the reference's uncertainty.
std::string remark(const scene::Figure& value, const scene::Figure* uncertainty) {
  if (uncertainty == nullptr || !value.text.empty()) return "";
  if (!uncertainty->text.empty()) return "";
  return std::abs(value.number) <= uncertainty->number ? "not distinguishable" : "";
}

/// False for a figure that is undefined in this scene.
bool applies(const scene::Figure& figure) { return !figure.text.starts_with("undefined"); }

Section figures_section(const ReportContent& c) {
  constexpr std::pair<std::string_view, std::string_view> groups[] = {{"force.", "Force"},
                                                                      {"shape.", "Shape"},
                                                                      {"contact.", "Contact"},
                                                                      {"reference.", "How good the reference is"},
                                                                      {"fast.", "What the fast model costs"}};
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th>Figure and its key in summary.json</th><th class=\"n\">Value"
      "</th><th class=\"n\">Reference’s own uncertainty</th><th></th></tr>\n";
  for (const auto& [prefix, name] : groups) {
    std::string rows;
    for (const scene::Figure& figure : c.figures) {
      if (!figure.key.starts_with(prefix) || figure.key.ends_with(uncertainty_suffix) || !applies(figure)) continue;
      const std::string partner_key = figure.key + std::string(uncertainty_suffix);
      const auto partner = std::find_if(c.figures.begin(), c.figures.end(),
                                        [&](const scene::Figure& f) { return f.key == partner_key; });
      const bool paired = partner != c.figures.end();
      rows += fmt::format(
          "<tr><td>{}<br/>{}</td>{}<td class=\"n\">{}{}</td>{}</tr>\n", escape_xml(figure_meaning(figure.key)),
          tag("code", figure.key), tag("td", figure_text(figure), figure.text.empty() ? "class=\"n\"" : "class=\"t\""),
          paired ? escape_xml(figure_text(*partner)) + "<br/>" : "",
          paired ? tag("code", "…" + std::string(uncertainty_suffix), fmt::format("title=\"{}\"", partner_key)) : "",
          cell(remark(figure, paired ? &*partner : nullptr)));
    }
    if (!rows.empty()) out += fmt::format("<tr class=\"group\"><th colspan=\"4\">{}</th></tr>\n", name) + rows;
  }
  out += "</table></div>\n";
  const auto left_out = std::count_if(c.figures.begin(), c.figures.end(), [](const auto& f) { return !applies(f); });
  if (left_out > 0) {
    out += tag("p", "Figures that are undefined in this scene are left out; summary.json gives the reasons.",
               "class=\"dim\"") +
           "\n";
  }
  return {"All figures", out, true};
}

Section reference_section(const ReportContent& c) {
  std::string out = tag("p", reference_sentence(c.result, c.errors)) + "\n";
  out +=
      tag("p", fmt::format("Model: {}. Linear solver: {}.{}", c.result.model, c.result.linear_solver,
                           c.result.from_store ? " Read from the store of earlier solutions; times are those of "
                                                 "the original solve."
                                               : "")) +
      "\n<div class=\"scroll\"><table>\n<tr><th class=\"n\">mesh</th><th class=\"n\">element size at the contact</th>"
      "<th class=\"n\">unknowns</th><th class=\"n\">force at the deepest instant</th><th class=\"n\">change</th><th "
      "class=\"n\">Newton iterations</th><th class=\"n\">load steps halved</th><th class=\"n\">time</th></tr>\n";
  double before_n = no_value;
  for (std::size_t i = 0; i < c.result.levels.size(); ++i) {
    const reference::LevelRecord& level = c.result.levels[i];
    const double force_n = level.force_n.size() > c.errors.deepest ? level.force_n[c.errors.deepest] : no_value;
    out += "<tr>" + number_cell(std::to_string(i + 1)) + number_cell(quantity_text(level.element_size_m, "m")) +
           number_cell(number_text(level.unknowns)) + number_cell(fmt::format("{} N", number_text(force_n, 4))) +
           number_cell(std::isfinite(before_n) && before_n > 0.0 ? percent_text(force_n / before_n - 1.0) : "–") +
           number_cell(number_text(level.newton_iterations)) + number_cell(number_text(level.steps_cut)) +
           number_cell(quantity_text(level.wall_s, "s")) + "</tr>\n";
    before_n = force_n;
  }
  return {"Reference", out + "</table></div>\n"};
}

Section plans_section(const ReportContent& c) {
  return {"What is modelled", tag("h3", "Fast model", "class=\"fast\"") + plan_table(c.plans.fast) +
                                  tag("h3", "Reference", "class=\"reference\"") + plan_table(c.plans.reference)};
}

}  // namespace

std::string report_html(const ReportContent& c) {
  const auto plots = [](const std::vector<Drawing>& drawings) {
    return "<div class=\"plots\">\n" + figures_of(drawings) + "</div>\n";
  };
  const std::vector<Section> sections = {
      why_section(c),
      next_section(c),
      {"Force", plots(c.drawings.forces)},
      {"Shape", plots(c.drawings.shapes)},
      instants_section(c),
      figures_section(c),
      reference_section(c),
      plans_section(c),
      resolved_scene(c.manifest),
      origin(c.manifest,
             "Beside this page: summary.json (all figures), curve.csv (every instant), shape.svg, manifest.json, and "
             "surface.pvd for ParaView, where the filter Warp By Vector with displacement_fast_m or "
             "displacement_reference_m shows a side."),
      words_section()};
  return page(scene_title(c.scene), tag("h1", scene_title(c.scene)) + "\n" + command_line(c.manifest) +
                                        contents(sections) + first_screen(c) + in_order(sections));
}

void write_report(const std::filesystem::path& path, const ReportContent& content) {
  scene::write_file(path, report_html(content));
}

}  // namespace touchstone::compare
