#include "compare/tune/tune_results.h"

#include "compare/errors/figures.h"
#include "compare/format/text.h"
#include "compare/tune/tune_report.h"
#include "scene/base/files.h"
#include "scene/input/fields.h"
#include "scene/output/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace touchstone::compare {
namespace {

using Field = scene::Field<scene::Scene>;

/// The reference's figures that describe one contact and do not depend on the machine.
scene::Figures reference_side(const Tuning& tuning, const TuningOutcome& outcome) {
  const scene::Figures all = reference_figures(tuning.data[outcome.data].result, outcome.errors.reference);
  scene::Figures out;
  for (const char* key : {"reference.force_uncertainty_rel", "reference.shape_uncertainty_rel", "reference.model"}) {
    out.push_back(*scene::find_figure(all, key));
  }
  return out;
}

/// The largest value of every error over the contacts, with the uncertainty of that contact.
scene::Figures worst_figures(const std::vector<scene::Figures>& contacts) {
  scene::Figures out;
  for (const scene::Figure& first : contacts.front()) {
    const Worst worst_is = worst_of(first.key);
    if (worst_is == Worst::none || first.key.ends_with(uncertainty_suffix)) continue;
    const scene::Figures* from = nullptr;
    const scene::Figure* worst = nullptr;
    for (const scene::Figures& figures : contacts) {
      const scene::Figure* one = scene::find_figure(figures, first.key);
      if (one == nullptr || !one->text.empty()) continue;
      const bool worse =
          worst == nullptr ||
          (worst_is == Worst::smallest ? one->number < worst->number : std::abs(one->number) > std::abs(worst->number));
      if (!worse) continue;
      worst = one;
      from = &figures;
    }
    out.push_back(worst != nullptr ? *worst : first);
    const scene::Figure* uncertainty =
        from != nullptr ? scene::find_figure(*from, first.key + std::string(uncertainty_suffix)) : nullptr;
    if (uncertainty != nullptr) out.push_back(*uncertainty);
  }
  return out;
}

void add(scene::Figures& out, const std::string& prefix, const scene::Figures& figures) {
  for (const scene::Figure& figure : figures)
    out.push_back({prefix + figure.key, figure.number, figure.text, figure.unit});
}

scene::Figures model_figures(const Tuning& tuning, const TunedModel& model) {
  scene::Figures out;
  for (const bool held_out : {true, false}) {
    const std::string group = held_out ? "held_out." : "training.";
    std::vector<scene::Figures> contacts;
    scene::Figures each;
    for (const TuningOutcome& outcome : model.outcomes) {
      const TuningData& data = tuning.data[outcome.data];
      if (data.held_out() != held_out) continue;
      contacts.push_back(error_figures(outcome.errors));
      const std::string prefix = group + slug(data.contact.name) + ".";
      add(each, prefix, contacts.back());
      add(each, prefix, reference_side(tuning, outcome));
    }
    if (contacts.empty()) continue;
    add(out, group, worst_figures(contacts));
    out.insert(out.end(), each.begin(), each.end());
  }
  for (std::size_t k = 0; k < model.shape_parts.size(); ++k)
    out.push_back({"training.shape_parts." + model.entry.account.parts[k].key, model.shape_parts[k], "", ""});
  for (const StageFit& stage : model.stages) {
    for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
      const TuningParameter& one = stage.parameters[k];
      const Determination& found = stage.fit.parameters[k];
      out.push_back({"parameter." + one.key, found.value, "", one.unit});
      const std::string key = "parameter." + one.key + (one.log ? ".error_rel" : ".error");
      if (found.error) {
        out.push_back({key, *found.error, "", one.log ? "" : one.unit});
      } else {
        out.push_back({key, NAN,
                       found.open                       ? "none: not determined by the data"
                       : found.at_bound == AtBound::low ? "none: at its lower bound"
                                                        : "none: at its upper bound",
                       ""});
      }
    }
    const std::string key = stage.stage == TuningStage::force ? "fit.force." : "fit.shape.";
    out.push_back({key + "chi2_per_freedom", stage.fit.chi2_per_freedom, "", ""});
    out.push_back({key + "free", static_cast<double>(stage.fit.free), "", ""});
    out.push_back({key + "rank", static_cast<double>(stage.fit.rank), "", ""});
    out.push_back({key + "condition", stage.fit.condition, std::isfinite(stage.fit.condition) ? "" : "infinite", ""});
    out.push_back({key + "starts", static_cast<double>(stage.fit.starts.size()), "", ""});
    out.push_back({key + "starts_agreeing", static_cast<double>(stage.fit.starts_agreeing), "", ""});
  }
  return out;
}

/// One row per contact and instant; contacts and models are numbered in the order of the study.
std::vector<scene::Column> tuning_columns(const Tuning& tuning) {
  std::vector<scene::Column> columns;
  for (const char* name : {"model", "contact", "held_out", "time_s", "depth_m", "fast_force_n", "reference_force_n",
                           "reference_force_uncertainty_n", "error_force_n", "error_shape_rel_l2"}) {
    columns.push_back({name, {}});
  }
  for (std::size_t m = 0; m < tuning.models.size(); ++m) {
    for (const TuningOutcome& outcome : tuning.models[m].outcomes) {
      for (const InstantErrors& e : outcome.errors.instants) {
        const double row[] = {static_cast<double>(m),
                              static_cast<double>(outcome.data),
                              tuning.data[outcome.data].held_out() ? 1.0 : 0.0,
                              e.time_s,
                              e.depth_m,
                              e.force_fast_n,
                              e.force_reference_n,
                              e.force_uncertainty_n,
                              e.force_error_n,
                              e.shape_rel_l2.value.value_or(NAN)};
        for (std::size_t k = 0; k < columns.size(); ++k) columns[k].values.push_back(row[k]);
      }
    }
  }
  return columns;
}

}  // namespace

scene::Figures tuning_figures(const Tuning& tuning) {
  scene::Figures out = model_figures(tuning, tuning.models.front());
  for (const TunedModel& model : tuning.models) add(out, model.entry.key + ".", model_figures(tuning, model));
  return out;
}

std::string parameters_toml(const Tuning& tuning, const TunedModel& model) {
  std::set<const Field*> tuned;
  for (const StageFit& stage : model.stages) {
    for (const TuningParameter& one : stage.parameters) tuned.insert(scene::tunable_field(one.key));
  }
  // The scene of a contact in which all tuned keys apply; those of friction may not apply in all.
  std::vector<scene::Scene> scenes;
  for (const TuningData& data : tuning.data) scenes.push_back(tuned_scene(data.contact.scene, model));
  const auto whole = std::ranges::find_if(scenes, [&](const scene::Scene& scene) {
    return std::ranges::all_of(tuned, [&](const Field* field) { return scene::applies(*field, scene); });
  });
  const scene::Scene& values = whole != scenes.end() ? *whole : scenes.front();
  // An optional table is written whole or not at all.
  const auto written = [&](const Field& field) {
    if (!field.tunable || !scene::applies(field, values)) return false;
    if (tuned.contains(&field)) return true;
    if (scene::in_optional_table(field)) {
      return std::ranges::any_of(
          tuned, [&](const Field* one) { return one->only_when && one->only_when->key == field.only_when->key; });
    }
    return scene::tunable_in(field, model.formulation) &&
           (scene::must_be_given(field) || field.tunable->stage == scene::TuningStage::model);
  };
  std::string keys, shared;
  std::string section;
  for (const Field& field : scene::scene_fields()) {
    if (!written(field)) continue;
    const std::string key(field.key);
    if (scene::reference_reads(field.side)) shared += (shared.empty() ? "" : ", ") + key;
    const std::size_t dot = key.rfind('.');
    if (key.substr(0, dot) != section) keys += "\n[" + (section = key.substr(0, dot)) + "]\n";
    keys += key.substr(dot + 1) + " = " + scene::value_text(field, values) + "\n";
  }
  std::string text = fmt::format(
      "# The {} model, tuned by the study {}.\n# A scene uses it with include = \"<this file>\" at its "
      "top, and leaves these keys out: a scene's own keys have precedence.\n",
      model.name(), tuning.study.name);
  if (!shared.empty())
    text += fmt::format(
        "# The reference reads {} too; with other values it solves a different scene. compare --parameters gives "
        "them to the fast model alone.\n",
        shared);
  return text + keys;
}

void write_tuning(const std::filesystem::path& folder, const Tuning& tuning, const scene::Manifest& manifest) {
  scene::write_file(folder / "parameters.toml", parameters_toml(tuning, tuning.models.front()));
  for (const TunedModel& model : tuning.models) {
    scene::write_file(folder / ("parameters-" + model.entry.key + ".toml"), parameters_toml(tuning, model));
  }
  scene::write_csv(folder / "curve.csv", tuning_columns(tuning));
  scene::write_summary(folder / "summary.json", tuning_figures(tuning));
  scene::write_file(folder / "report.html", tuning_report_html(tuning, manifest));
  scene::write_manifest(folder / "manifest.json", manifest);
}

}  // namespace touchstone::compare
