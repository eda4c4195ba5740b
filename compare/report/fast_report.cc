#include "compare/report/fast_report.h"

#include "compare/errors/figures.h"
#include "compare/format/page.h"
#include "compare/format/text.h"
#include "compare/report/fast_drawings.h"
#include "fast/command/results.h"
#include "fast/step/state.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::compare {
namespace {

std::string head_section(const scene::Scene& scene, const fast::Run& run) {
  const auto strongest = std::max_element(run.instants.begin(), run.instants.end(), [](const auto& a, const auto& b) {
    return a.force_n().norm() < b.force_n().norm();
  });
  std::string out = tag("h1", scene_title(scene)) + "\n";
  out += tag("p",
             fmt::format("What the fast contact model computed alone, in the {} formulation, at {} steps a second over "
                         "{} of track.",
                         scene::name_of(scene.fast.formulation), number_text(scene.fast.rate_hz),
                         seconds_text(run.instants.back().time_s)),
             "class=\"dim\"") +
         "\n<div class=\"tiles\">\n";
  out += tile("Largest force", quantity_text(strongest->force_n().norm(), "N"),
              fmt::format("at {}, {} deep", seconds_text(strongest->time_s), quantity_text(strongest->depth_m, "m")));
  out += tile("One step", quantity_text(run.step.p50_us, "us"), "median");
  out += tile("99 % of the steps are shorter than", quantity_text(run.step.p99_us, "us"),
              fmt::format("99.9 % than {}", quantity_text(run.step.p999_us, "us")));
  out += tile("Status", fast::status_text(run.status), "of all steps");
  return out + "</div>\n";
}

std::string drawings_section(const std::string& title, const std::vector<Drawing>& drawings) {
  std::string out = tag("h2", title) + "\n<div class=\"plots\">\n";
  for (const Drawing& drawing : drawings) out += figure(drawing.svg, drawing.caption, drawing.wide);
  return out + "</div>\n";
}

std::string figures_section(const fast::Run& run) {
  std::string out = tag("h2", "All figures") +
                    "\n<div class=\"scroll\"><table>\n<tr><th>Figure and its key in summary.json</th>"
                    "<th class=\"n\">Value</th></tr>\n";
  for (const scene::Figure& figure : fast::figures(run)) {
    out += fmt::format("<tr><td>{}<br/>{}</td>{}</tr>\n", escape_xml(figure_meaning(figure.key)),
                       tag("code", figure.key), number_cell(figure_text(figure)));
  }
  return out + "</table></div>\n";
}

}  // namespace

std::string fast_report_html(const scene::Scene& scene, const fast::Run& run, const scene::Manifest& manifest) {
  const std::vector<Drawing> forces = force_drawings(scene, run);
  std::string out = head_section(scene, run);
  out += forces.empty() ? tag("p", "The tool never touches the body.") + "\n" : drawings_section("Force", forces);
  out += drawings_section("Shape", shape_drawings(scene, run)) + figures_section(run);
  out += tag("h2", "What the fast model computes of the scene") + "\n" + plan_table(fast::plan(scene));
  out += manifest_section(
      manifest,
      "Beside this page: the drawings as SVG files, summary.json (these figures), curve.csv (every "
      "instant), beams.csv (every beam end of a skeleton), manifest.json, and surface.pvd for ParaView, where "
      "the filter Warp By Vector with "
      "displacement_m shows the deformed body.");
  return page(scene_title(scene), out);
}

void write_fast_report(const std::filesystem::path& folder, const scene::Scene& scene, const fast::Run& run,
                       const scene::Manifest& manifest) {
  for (const std::string& name : drawing_names()) std::filesystem::remove(folder / (name + ".svg"));
  for (const auto& drawings : {force_drawings(scene, run), shape_drawings(scene, run)}) {
    for (const Drawing& drawing : drawings) scene::write_file(folder / (drawing.name + ".svg"), as_file(drawing.svg));
  }
  scene::write_file(folder / "report.html", fast_report_html(scene, run, manifest));
}

}  // namespace touchstone::compare
