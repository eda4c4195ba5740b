#include "compare/model/skeleton_model.h"

#include "compare/format/text.h"
#include "compare/input/tuning_study.h"
#include "compare/model/engine_model.h"
#include "fast/step/state.h"
#include "reference/verification/closed_forms.h"
#include "scene/model/area_law.h"
#include "scene/model/solid_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace touchstone::compare {
namespace {

using scene::Scene;

ModelFamily family_of(const Scene& scene) {
  return scene.contact.law == scene::ContactLaw::duffing ? ModelFamily::paper : ModelFamily::area_aware;
}

/// The paper's Table I for rubber, read in millimetres and newtons: k1 = m w0^2, k3 = (3/4) m b0^2 eps (errata E2).
constexpr double table1_k1_n_per_m = 40.0, table1_k3_n_per_m3 = 3.0e8;

/// The law disagrees with the material if one gives this many times the other's force.
constexpr double mismatch = 2.0;

bool has(std::uint32_t status, fast::StepStatus bit) { return (status & static_cast<std::uint32_t>(bit)) != 0; }

/// Two significant digits, as a user would type them.
std::string typed(double value) { return fmt::format("{:.2g}", value); }

std::string newtons(double force_n) { return quantity_text(force_n, "N"); }

/// Stiffer beams if anchor points were limited, else the stiffness with the smallest shape error.
void other_beams(Advice& advice) {
  const scene::Scene& scene = advice.scene();
  const Errors& errors = advice.errors();
  const bool limited = has(advice.status(), fast::StepStatus::anchors_limited);
  const double before = errors.shape_rel_l2.value.value_or(0.0);
  if (!limited && !(errors.shape_rel_l2.distinguishable() && before > 0.5)) return;
  std::optional<std::pair<double, Trial>> best;
  const std::vector<double> powers =
      limited ? std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8} : std::vector<double>{1, 2, 3, -1, -2};
  for (const double power : powers) {
    if (!advice.time_left()) break;
    scene::Scene changed = scene;
    const double factor = std::pow(4.0, power);
    changed.fast.s_c_m2 = std::stod(typed(factor * scene.fast.s_c_m2));
    const Trial trial = advice.tried(changed);
    if (has(trial.status, fast::StepStatus::anchors_limited)) continue;
    if (!best || trial.shape_rel_l2 < best->second.shape_rel_l2) best = {changed.fast.s_c_m2, trial};
    // Beams only need to be stiff enough; much stiffer ones would not move at all.
    if (limited && trial.shape_rel_l2 > best->second.shape_rel_l2) break;
  }
  if (!best || (!limited && best->second.shape_rel_l2 > Advice::worth_it * before)) return;
  const bool stiffer = best->first > scene.fast.s_c_m2;
  advice.again(
      fmt::format("Take {} beams. Tried: the shape error goes from {} to {}{}.", stiffer ? "stiffer" : "softer",
                  percent_text(before), percent_text(best->second.shape_rel_l2),
                  limited ? ", and no anchor displacement is limited" : ""),
      " --set fast.s_c_m2=" + typed(best->first));
}

void area_law(Advice& advice) {
  const scene::Scene& scene = advice.scene();
  const Errors& errors = advice.errors();
  const double before = errors.force_nrmse.value.value_or(0.0);
  if (scene.contact.law != scene::ContactLaw::duffing || !errors.force_nrmse.distinguishable() ||
      before < Advice::small_error || !advice.time_left())
    return;
  const scene::Scene changed = with_untuned_area_law(scene);
  const Trial trial = advice.tried(changed);
  if (!(trial.force_nrmse < Advice::worth_it * before)) return;
  advice.with_parameters(
      fmt::format(
          "Take the area-aware law with the material's modulus and stiff beams. Tried: force error from {} to {}, "
          "shape error from {} to {}.",
          percent_text(before), percent_text(trial.force_nrmse), percent_text(errors.shape_rel_l2.value.value_or(0.0)),
          percent_text(trial.shape_rel_l2)),
      "area-aware",
      fmt::format("# The area-aware law F = k1 D. Its constant follows from the material, s_c from the body's size:\n"
                  "# nothing is tuned.\n"
                  "[contact]\nlaw = \"area_aware\"\nk1_per_radius_n_per_m2 = {:.6g}\nk3_n_per_m3 = 0.0\n\n"
                  "[fast]\ns_c_m2 = {:.6g}\n",
                  changed.contact.k1_per_radius_n_per_m2, changed.fast.s_c_m2));
}

/// The likely cause of the force error.
Reason force_cause(const scene::Scene& scene, const Errors& errors) {
  const InstantErrors& deepest = errors.instants[errors.deepest];
  if (!errors.force_peak_rel.distinguishable() || !(deepest.force_fast_n > 0.0)) return {};
  const double d = deepest.depth_m;
  const double law_n = scene.contact.k1_n_per_m * d + scene.contact.k3_n_per_m3 * d * d * d;
  // As in Hertz's formula, Duffing's force depends on the depth alone.
  const bool duffing = scene.contact.law == scene::ContactLaw::duffing;
  const std::optional<double> hertz_n = duffing ? hertz_force_n(scene, d) : std::nullopt;
  Reason out{.about = "Likely cause"};
  const bool too_low = hertz_n && law_n * mismatch < *hertz_n && deepest.force_fast_n < deepest.force_reference_n;
  const bool too_high = hertz_n && law_n > mismatch * *hertz_n && deepest.force_fast_n > deepest.force_reference_n;
  if (too_low || too_high) {
    out.brief = fmt::format(
        "The contact constants do not describe the material: the contact law gives {} at D = {}, Hertz's formula "
        "about {}.",
        newtons(law_n), quantity_text(d, "m"), newtons(*hertz_n));
    out.detail = fmt::format(
        "The law is F\u00a0=\u00a0k1\u00a0D\u00a0+\u00a0k3\u00a0D³ with k1 = {} N/m and k3 = {} N/m³; Hertz's formula "
        "takes "
        "E = {} MPa and ν = {}. k1 and k3 do not follow from Young's modulus: they must be tuned.",
        number_text(scene.contact.k1_n_per_m), number_text(scene.contact.k3_n_per_m3),
        number_text(1e-6 * scene.body.material.youngs_modulus_pa), number_text(scene.body.material.poissons_ratio));
    if (scene.contact.k1_n_per_m == table1_k1_n_per_m && scene.contact.k3_n_per_m3 == table1_k3_n_per_m3) {
      out.detail += " These constants are the paper's Table I for rubber, read in millimetres and newtons.";
    }
    if (deepest.force_fast_n < 0.95 * law_n) {
      out.detail += fmt::format(
          " The model's force of {} is less than that, because its depth is a mean over the contact region.",
          newtons(deepest.force_fast_n));
    }
  }
  // A constant factor can be corrected by scaling; a factor that varies with the depth cannot.
  double least = std::numeric_limits<double>::infinity(), most = 0.0, at_least_m = 0.0, at_most_m = 0.0;
  for (const InstantErrors& e : errors.instants) {
    if (!e.deep || !(e.force_reference_n > 0.0)) continue;
    const double ratio = e.force_fast_n / e.force_reference_n;
    if (ratio < least) {
      least = ratio;
      at_least_m = e.depth_m;
    }
    if (ratio > most) {
      most = ratio;
      at_most_m = e.depth_m;
    }
  }
  if (most > 1.3 * least) {
    const std::string form = fmt::format(
        "the fast model gives {} of the reference's force at {} and {} at {}, so no constant factor can correct it.",
        percent_text(least), quantity_text(at_least_m, "m"), percent_text(most), quantity_text(at_most_m, "m"));
    if (out.brief.empty()) {
      out.brief = "The form of the contact law: " + form;
    } else {
      out.detail += " The law's form matters too: " + form;
    }
  } else if (out.brief.empty() && least < most * (1.0 + 1e-12) && std::isfinite(least) && std::abs(most - 1.0) > 0.05) {
    out.brief = fmt::format(
        "The contact constants are not tuned to this contact. The fast model gives {} to {} of the reference's force "
        "at every depth, so another constant would correct it.",
        percent_text(least), percent_text(most));
  }
  return out;
}

void advise_skeleton(Advice& advice) {
  other_beams(advice);
  area_law(advice);
  advice.tune("meshes/studies/ball-on-cube.toml", "");
}

ModelEntry skeleton(ModelEntry entry, const SceneChange& change) {
  entry.set_up = [change](const Scene& scene) { return engine_model(change(scene)); };
  return entry;
}

}  // namespace

Scene as_printed(Scene scene) {
  scene.fast.formulation = scene::Formulation::published;
  return scene;
}

Scene corrected(Scene scene) {
  scene.fast.formulation = scene::Formulation::corrected;
  return scene;
}

Scene with_untuned_area_law(Scene scene) {
  scene.contact.law = scene::ContactLaw::area_aware;
  scene.contact.k1_per_radius_n_per_m2 =
      scene::area_law_constant_n_per_m2(scene.body.material, scene.tool, scene.fast.formulation);
  scene.contact.k1_n_per_m = scene.contact.k3_n_per_m3 = 0.0;
  scene.fast.s_c_m2 = scene::stiff_beam_area_m2(scene.body);
  return scene;
}

std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m) {
  const scene::Body& body = scene.body;
  if (scene.tool.shape != scene::ToolShape::sphere || body.shape == scene::BodyShape::revolution ||
      !body.inclusions.empty())
    return std::nullopt;
  const double curvature_per_m = 1.0 / scene.tool.radius_m + scene::top_curvature_per_m(body);
  return verification::hertz(body.material.contact_modulus_pa(), 1.0 / curvature_per_m, depth_m).force_n;
}

ModelEntry skeleton_model(const Scene& scene, const Say&) {
  const scene::LawName& law = scene::name_of(scene.contact.law);
  const std::string form(scene::name_of(scene.fast.formulation)), title(law.title);
  const auto without = [](bool factor, bool anchors) {
    return [=](Scene changed) {
      // A beam area of a million square metres: the beams do not deform.
      constexpr double stiff_s_c_m2 = 1e6;
      if (factor) changed.fast.C_n = 0.0;
      if (anchors) changed.fast.s_c_m2 = stiff_s_c_m2;
      return changed;
    };
  };
  return {
      .name = form + " skeleton, " + title + " law",
      .key = form + "-" + std::string(law.word),
      .label = form + (scene.contact.law == scene::ContactLaw::duffing ? "" : ", " + title),
      .method = title + ", " + form,
      .family = family_of(scene),
      .set_up = engine_model,
      .replay = engine_replay,
      .account = {.name = form + " " + title,
                  .far_shape = ": only the anchor points move the surface there, and the local factor has no effect",
                  .untouched_faces = ", which only the anchor points move,",
                  .parts = {{"whole", without(false, false)},
                            {"without_local_factor", without(true, false)},
                            {"anchors_at_rest", without(false, true)},
                            {"hat_alone", without(true, true)}},
                  .parts_sentence = "{3} with the contact point's kernel function alone, {1} with the anchor points' "
                                    "displacements added, {2} with the local factor added instead, {0} with both",
                  .cause = force_cause,
                  .advise = advise_skeleton}};
}

std::vector<ModelEntry> skeleton_models(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  const scene::ContactLaw law = request.scene.contact.law;
  const std::string own_word(scene::name_of(law).word), own_title(scene::name_of(law).title);
  const bool own_area_law = law == scene::ContactLaw::area_aware;
  using Form = std::pair<const char*, Scene (*)(Scene)>;
  for (const auto& [name, change] : {Form{"published", as_printed}, Form{"corrected", corrected}}) {
    const std::string form = name;
    if (law == scene::ContactLaw::duffing) {
      models.push_back(skeleton({.name = form + " skeleton, Duffing law of the scene",
                                 .key = form + "-duffing",
                                 .label = form,
                                 .family = ModelFamily::paper},
                                change));
    } else {
      models.push_back({.name = form + " skeleton, Duffing law",
                        .key = form + "-duffing",
                        .family = ModelFamily::paper,
                        .absent = "the scene's law is the " + own_title + " one"});
      if (!own_area_law) {
        models.push_back(skeleton({.name = form + " skeleton, " + own_title + " law of the scene",
                                   .key = form + "-" + own_word,
                                   .label = form + ", " + own_title,
                                   .family = ModelFamily::area_aware},
                                  change));
      }
    }
    const std::string from = own_area_law ? "of the scene" : "k1 and s_c of material and size";
    models.push_back(skeleton({.name = form + " skeleton, area-aware law, " + from,
                               .key = form + "-area-aware",
                               .label = form + ", area-aware",
                               .family = ModelFamily::area_aware},
                              [change = change, own_area_law](Scene scene) {
                                scene = change(std::move(scene));
                                return own_area_law ? scene : with_untuned_area_law(std::move(scene));
                              }));
  }
  return models;
}

std::vector<ModelEntry> skeleton_meshes(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  const std::vector<int> sizes = request.quick ? std::vector{400, 1000} : std::vector{1000, 3952, 16000, 100000};
  const bool tuned = !request.parameters.empty();
  for (const int triangles : sizes) {
    if (triangles == request.scene.fast.triangles) continue;  // already in the list
    const SceneChange change = [triangles, tuned, file = tuned ? request.parameters.front() : ""](Scene scene) {
      if (tuned) scene = with_parameters(std::move(scene), file);
      scene.fast.triangles = triangles;
      return corrected(std::move(scene));
    };
    models.push_back(skeleton(
        {.name = fmt::format("corrected skeleton{}, {} triangles", tuned ? ", tuned" : "", thousands_text(triangles)),
         .key = "corrected-" + thousands_text(triangles),
         .label = thousands_text(triangles),
         .family = family_of(change(request.scene)),
         .triangles = triangles},
        change));
  }
  return models;
}

std::vector<ModelEntry> skeleton_anchor_sets(const ModelRequest&) {
  return {{.name = "anchor sets",
           .key = "anchors",
           .family = ModelFamily::paper,
           .absent = "the anchor points follow from the body's shape by the paper's rule: no scene has a setting for "
                     "them"}};
}

}  // namespace touchstone::compare
