#include "fast/run/run.h"
#include "fast/step/engine.h"
#include "scene/base/index.h"
#include "scene/model/rest_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>

namespace touchstone::fast {
namespace {

/// Measured time of a tick at the deepest instant of the track.
struct Measured {
  std::array<double, stage_count> stage_us{};  ///< medians
  double step_us = 0.0;
  int points = 0, regions = 0;
  bool contact = false;
  double deepest_m = 0.0;  ///< by the exact shapes

  [[nodiscard]] std::string cost(std::initializer_list<Stage> stages) const {
    double sum_us = 0.0;
    for (const Stage stage : stages) sum_us += nth(stage_us, stage);
    return contact ? fmt::format("{:.2f} us a tick, measured", sum_us) : "no contact at the track's instants";
  }
};

Measured measure(const scene::Scene& scene, Engine& engine) {
  const std::vector<double> times_s = scene::instants_s(scene);
  const scene::RestDepth depth(*engine.model().body, scene.tool);
  const FastState& state = engine.state();
  // Runs the track up to that instant, so that regions and friction are as in the scene.
  double deepest_s = times_s.front();
  Measured measured;
  for (const double time_s : times_s) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    engine.step(pose);
    measured.regions = std::max(measured.regions, state.region_count);
    if (const double here_m = depth.depth_m(pose); here_m > measured.deepest_m) {
      measured.deepest_m = here_m;
      deepest_s = time_s;
    }
  }
  const scene::Pose pose = scene::pose_at(scene.track, deepest_s);
  engine.time_stages(true);
  constexpr int ticks = 201;
  std::array<std::vector<double>, stage_count> stage_us;
  std::vector<double> step_us;
  for (int i = 0; i < ticks; ++i) {
    engine.step(pose);
    double& sum_us = step_us.emplace_back(0.0);
    for (std::size_t s = 0; s < stage_count; ++s) {
      stage_us[s].push_back(engine.stages().spent_us(static_cast<Stage>(s)));
      sum_us += stage_us[s].back();
    }
  }
  for (std::size_t s = 0; s < stage_count; ++s) measured.stage_us[s] = percentile_us(std::move(stage_us[s]), 0.5);
  measured.step_us = percentile_us(std::move(step_us), 0.5);
  measured.contact = state.in_contact();
  for (int i = 0; i < state.region_count; ++i) measured.points += nth(state.regions, i).points.count;
  return measured;
}

/// "8 vertices, 4 on a circle": the number of anchor points for each reason.
std::string anchors_text(const AnchorPoints& anchors) {
  std::string out;
  std::vector<AnchorReason> told;
  for (const AnchorReason reason : anchors.reasons()) {
    if (std::find(told.begin(), told.end(), reason) != told.end()) continue;
    told.push_back(reason);
    const auto count = std::count(anchors.reasons().begin(), anchors.reasons().end(), reason);
    out += (out.empty() ? "" : ", ") + std::to_string(count) + " x " + std::string(words(reason));
  }
  return out;
}

std::string one_region_text(const scene::Tool& tool) {
  if (!tool.convex()) return "fast.max_regions = 1";
  const std::string touch = "a convex body and a convex tool touch in one region";
  if (!tool.mesh) return touch;
  const scene::Bounds bounds = tool.mesh->bounds();
  const double dent_m = scene::convex_tolerance_rel * (bounds.upper_m - bounds.lower_m).norm();
  return touch + fmt::format("; the tool's mesh has no concavity deeper than {:.2g} mm", dent_m * 1e3);
}

}  // namespace

scene::Plan plan(const scene::Scene& scene) {
  Engine engine(scene);
  const FastModel& model = engine.model();
  const Measured measured = measure(scene, engine);
  const bool published = scene.fast.formulation == scene::Formulation::published;
  const std::string printed = published ? "as printed" : "corrected", elements = published ? "samples" : "cells";
  const auto held = std::count(model.skeleton.held.begin(), model.skeleton.held.end(), true);

  scene::Plan plan;
  const auto models = [&](const char* part, std::string reason, std::string cost = "") {
    plan.push_back({part, true, std::move(reason), std::move(cost)});
  };
  const auto leaves_out = [&](const char* part, std::string reason) {
    plan.push_back({part, false, std::move(reason), "nothing"});
  };
  models(
      "contact detection",
      fmt::format("{} {} of the tool, {:.3g} mm apart, against the exact rest shape{}; {} points inside at the track's "
                  "deepest instant",
                  model.tool.count(), elements, model.tool.spacing_m * 1e3,
                  published ? "" : ", and smaller ones where few are inside", measured.points) +
          (measured.deepest_m > 0.0 && !measured.contact
               ? fmt::format("; CONTACT MISSED: the tool is {:.3g} mm deep there but the force is zero; raise "
                             "fast.tool_samples",
                             measured.deepest_m * 1e3)
               : ""),
      measured.cost({Stage::detection}));
  if (model.max_regions > 1) {
    models(
        "several regions",
        fmt::format("the tool's mesh is not convex: up to {}, {} at the track's instants, separated at {:.3g} mm; each "
                    "is evaluated on the body deformed by the earlier ones",
                    model.max_regions, measured.regions, scene.contact.r_th_m * 1e3) +
            (scene.contact.r_th_m < 2.0 * model.tool.spacing_m
                 ? "; ONE CONTACT MAY SPLIT INTO SEVERAL: contact.r_th_m is less than twice the distance between " +
                       elements + "; raise fast.tool_samples"
                 : ""),
        measured.cost({Stage::regions}));
  } else {
    leaves_out("several regions", one_region_text(scene.tool));
  }
  models("contact force",
         std::string(scene::name_of(scene.contact.law).title) + " law along the direction of deformation, masses " +
             printed + ", torque about the tool's mass centre",
         measured.cost({Stage::force}));
  if (model.friction) {
    models("friction",
           fmt::format("sticking up to {:.3g} F_n^{:.3g}, slipping at {:.3g} F_n, ", scene.contact.friction->K,
                       scene.contact.friction->beta, scene.contact.friction->mu_D) +
               (published
                    ? "C1 to C4 as printed"
                    : fmt::format("tangential stiffness {:.3g} times the normal one while sticking, by return mapping",
                                  scene.contact.friction->stiffness_ratio)),
           measured.cost({Stage::friction}));
  } else {
    leaves_out("friction", "the scene has no [contact.friction]; the force is along the direction of deformation");
  }
  models(
      "beam skeleton",
      fmt::format("{} beams, {} of them ending on the support, anchor points: ", model.skeleton.anchor_m.size(), held) +
          anchors_text(*model.anchors) + "; force split " + printed,
      measured.cost({Stage::skeleton}));
  if (!scene.body.inclusions.empty()) {
    models("inclusions", fmt::format("{}: a beam is cut where it crosses one", scene.body.inclusions.size()),
           "within the beam skeleton");
  } else {
    leaves_out("inclusions", "the body is of one material, every beam one segment");
  }
  models("surface",
         fmt::format("{} triangles, {} rest points, ", model.surface.triangle_count(), model.surface.vertex_count()) +
             (published ? "lengths and angles interpolated" : "displacement vectors interpolated"),
         measured.cost({Stage::interpolation}));
  if (model.formulas.local_factor()) {
    models(
        "local factor",
        fmt::format("C_n = {:.3g} inside {:.3g} mm of the contact, ", scene.fast.C_n, scene.fast.r_R_m * 1e3) + printed,
        measured.cost({Stage::local_factor}));
  } else {
    leaves_out("local factor", "C_n = 0");
  }
  models("normals", "of the deformed surface", measured.cost({Stage::normals}));
  models("whole step", "all stages", fmt::format("{:.1f} us a tick, measured", measured.step_us));
  models("memory", "model and state, taken before the first tick",
         fmt::format("{:.1f} MB", static_cast<double>(engine.memory_bytes()) / 1e6));
  leaves_out("time dependence", "the paper's law is the static force; the track's speed does not enter");
  return plan;
}

}  // namespace touchstone::fast
