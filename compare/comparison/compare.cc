#include "compare/comparison/compare.h"

#include "compare/errors/compute_errors.h"
#include "compare/errors/figures.h"
#include "compare/format/svg_plot.h"
#include "compare/model/engine_model.h"
#include "compare/model/registry.h"
#include "compare/report/comparison_drawings.h"
#include "compare/report/model_table.h"
#include "compare/report/plot_files.h"
#include "compare/report/report.h"
#include "compare/report/verdict.h"
#include "compare/report/vtk_out.h"
#include "fast/command/results.h"

#include <limits>

namespace touchstone::compare {

std::vector<scene::Column> curve_columns(const fast::Run& run, const reference::Result& result, const Errors& errors) {
  std::vector<scene::Column> columns = scene::track_columns(result.instants);
  for (scene::Column& c : scene::record_columns(run.instants, "fast_")) columns.push_back(std::move(c));
  for (scene::Column& c : scene::record_columns(result.instants, "reference_")) columns.push_back(std::move(c));
  const auto add = [&](const char* name, const auto& get) {
    scene::Column column{name, {}};
    for (const InstantErrors& e : errors.instants) column.values.push_back(get(e));
    columns.push_back(std::move(column));
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  add("fast_force_n", [](const InstantErrors& e) { return e.force_fast_n; });
  add("reference_force_n", [](const InstantErrors& e) { return e.force_reference_n; });
  add("error_force_n", [](const InstantErrors& e) { return e.force_error_n; });
  add("error_force_rel", [&](const InstantErrors& e) { return e.force_error_rel.value_or(none); });
  if (errors.friction) {
    add("way_m", [](const InstantErrors& e) { return e.path_m; });
    add("fast_friction_n", [](const InstantErrors& e) { return e.friction_fast_n; });
    add("reference_friction_n", [](const InstantErrors& e) { return e.friction_reference_n; });
  }
  add("error_shape_rel_l2", [&](const InstantErrors& e) { return e.shape_rel_l2.value.value_or(none); });
  add("reference_shape_uncertainty_rel_l2",
      [&](const InstantErrors& e) { return e.shape_rel_l2.uncertainty.value_or(none); });
  add("error_shape_max_m", [](const InstantErrors& e) { return e.shape_max_m; });
  add("error_hausdorff_m", [](const InstantErrors& e) { return e.hausdorff_m; });
  add("contact_area_iou", [&](const InstantErrors& e) { return e.contact_area_iou.value_or(none); });
  add("fast_volume_change_rel", [](const InstantErrors& e) { return e.volume_change_fast_rel; });
  for (scene::Column& c : reference_quality_columns(result, "reference_")) columns.push_back(std::move(c));
  return columns;
}

Comparison write_comparison(const std::filesystem::path& folder, const scene::Scene& scene, const fast::Run& run,
                            const reference::Result& result, const scene::Manifest& manifest,
                            const Contenders& contenders, const Call& call, const reference::Inside* inside) {
  const Errors errors = compute_errors(scene, run, result.instants);
  const Plans plans{fast::plan(scene), reference::plan(scene)};
  const Verdict told = verdict(scene, run, result, errors, call, fast_model(scene));
  const std::vector<JudgedModel> models = judge_models(contenders, run.surface, result.instants,
                                                       {.force_nrmse = errors.force_nrmse,
                                                        .shape_rel_l2 = errors.shape_rel_l2,
                                                        .step_p50_us = run.step.p50_us,
                                                        .pressure_rel_l2 = errors.contact_pressure_rel_l2,
                                                        .pressure_peak_rel = errors.contact_pressure_peak_rel,
                                                        .trouble = trouble_of(run)});
  const ComparisonDrawings drawings = comparison_drawings(scene, run, result, errors, inside);
  Comparison comparison{make_figures(errors, result, fast::figures(run)),
                        told.text() + model_table_text(models) + "\n"};
  for (scene::Figure& figure : model_figures(models)) comparison.figures.push_back(std::move(figure));
  scene::write_csv(folder / "curve.csv", curve_columns(run, result, errors));
  write_surfaces(folder, run, result, errors);
  write_tool(folder, scene.tool, result.instants);
  scene::write_file(folder / "shape.svg", as_file(drawings.bodies_in_a_row));
  if (call.compare.plots) write_plots(folder / "plots", drawings.all());
  for (const NextStep& step : told.next) {
    if (!step.file_name.empty()) scene::write_file(folder / step.file_name, step.file_text);
  }
  scene::write_summary(folder / "summary.json", comparison.figures);
  scene::write_manifest(folder / "manifest.json", manifest);
  write_report(folder / "report.html",
               {scene, run, result, errors, comparison.figures, told, drawings, plans, manifest, models});
  return comparison;
}

}  // namespace touchstone::compare
