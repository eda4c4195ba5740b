#include "compare/report/model_table.h"

#include "compare/errors/compute_errors.h"
#include "compare/format/page.h"
#include "compare/format/text.h"
#include "compare/model/skeleton_model.h"
#include "fast/step/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace touchstone::compare {
namespace {

constexpr std::string_view reading_note =
    "Force error: root mean square over the track, relative to the largest force. Shape error: relative to the "
    "displacement; a body that never moves would have 100 %. <: below the reference's uncertainty.";

bool same_model(const scene::Scene& a, const scene::Scene& b) {
  return a.fast.formulation == b.fast.formulation && a.contact.law == b.contact.law &&
         a.contact.k1_n_per_m == b.contact.k1_n_per_m && a.contact.k3_n_per_m3 == b.contact.k3_n_per_m3 &&
         a.contact.k1_per_radius_n_per_m2 == b.contact.k1_per_radius_n_per_m2 && a.fast.s_c_m2 == b.fast.s_c_m2;
}

std::string method_of(const scene::Scene& scene) {
  return fmt::format("{}, {}", scene.contact.law == scene::ContactLaw::duffing ? "Duffing" : "area-aware",
                     scene.fast.formulation == scene::Formulation::published ? "published" : "corrected");
}

/// What lies below the reference's uncertainty is not known any better than that.
std::string error_text(const Measure& error) {
  if (!error.value) return "–";
  return error.distinguishable() ? percent_text(*error.value) : "< " + percent_text(*error.uncertainty);
}

JudgedModel judged_model(std::string key, std::string name, const scene::Scene& scene, const fast::Run& run,
                         const Errors& errors) {
  return {.key = std::move(key),
          .name = std::move(name),
          .method = method_of(scene),
          .force_nrmse = errors.force_nrmse,
          .shape_rel_l2 = errors.shape_rel_l2,
          .step_p50_us = run.step.p50_us,
          .status = run.status};
}

/// Length in characters of a UTF-8 text.
std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(std::string_view text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, characters(text)), ' ');
  return right ? space + std::string(text) : std::string(text) + space;
}

}  // namespace

std::vector<JudgedModel> judge_models(const scene::Scene& given, const scene::Scene& judged, const fast::Run& run,
                                      const Errors& errors, const reference::Result& result, const std::string& tuned) {
  const bool duffing = given.contact.law == scene::ContactLaw::duffing;
  struct Candidate {
    std::string key, name;
    scene::Scene scene;
  };
  std::vector<Candidate> candidates;
  if (duffing) candidates.push_back({"paper", "paper as printed", as_printed(given)});
  candidates.push_back({"area_aware", "untuned, from the material", with_untuned_area_law(corrected(given))});
  candidates.push_back({"scene", "scene's own constants", given});
  if (!tuned.empty()) candidates.push_back({"tuned", "tuned: " + tuned, judged});

  std::vector<JudgedModel> models;
  for (auto one = candidates.begin(); one != candidates.end(); ++one) {
    const bool is_tuned = one->key == "tuned";
    const bool listed = std::any_of(candidates.begin(), one,
                                    [&](const Candidate& other) { return same_model(other.scene, one->scene); });
    if (listed && !is_tuned) continue;
    if (tuned.empty() ? same_model(one->scene, judged) : is_tuned) {
      models.push_back(judged_model(one->key, one->name, one->scene, run, errors));
      continue;
    }
    const fast::Run other = fast::run(one->scene);
    models.push_back(
        judged_model(one->key, one->name, one->scene, other, compute_errors(one->scene, other, result.instants)));
  }
  return models;
}

std::string model_table_text(const std::vector<JudgedModel>& models) {
  std::vector<std::vector<std::string>> rows{{"model", "law, skeleton", "force", "shape", "step"}};
  for (const JudgedModel& model : models) {
    rows.push_back({model.name, model.method, error_text(model.force_nrmse), error_text(model.shape_rel_l2),
                    quantity_text(model.step_p50_us, "us")});
  }
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], characters(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) text += "  " + padded(row[c], widths[c], c >= 2);
    text += '\n';
  }
  return "Models on this contact, and their errors:\n" + text + wrapped(reading_note, 80) + "\n";
}

std::string model_table_html(const std::vector<JudgedModel>& models) {
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th>Model</th><th>Law, skeleton</th><th class=\"n\">Force error</th>"
      "<th class=\"n\">Shape error</th><th class=\"n\">Step, median</th></tr>\n";
  for (const JudgedModel& model : models) {
    out += "<tr>" + cell(model.name + (model.status == 0 ? "" : " (" + fast::status_text(model.status) + ")")) +
           cell(model.method) + number_cell(error_text(model.force_nrmse)) +
           number_cell(error_text(model.shape_rel_l2)) + number_cell(quantity_text(model.step_p50_us, "us")) +
           "</tr>\n";
  }
  return out + "</table></div>\n" + tag("p", std::string(reading_note), "class=\"dim\"") + "\n";
}

scene::Figures model_figures(const std::vector<JudgedModel>& models) {
  scene::Figures out;
  for (const JudgedModel& model : models) {
    const auto add = [&](const char* key, const std::optional<double>& value, const char* why_not) {
      const double number = value.value_or(std::numeric_limits<double>::quiet_NaN());
      out.push_back({"model." + model.key + "." + key, number, value ? "" : why_not, ""});
    };
    const char* none = "undefined: the reference is never in contact";
    add("force.nrmse", model.force_nrmse.value, none);
    add("force.nrmse_uncertainty", model.force_nrmse.uncertainty, "unknown");
    add("shape.rel_l2", model.shape_rel_l2.value, none);
    add("shape.rel_l2_uncertainty", model.shape_rel_l2.uncertainty, "unknown");
    out.push_back({"model." + model.key + ".step_us.p50", model.step_p50_us, "", "us"});
  }
  return out;
}

}  // namespace touchstone::compare
