#include "fast/response/checked_range.h"
#include "fast/response/response_engine.h"
#include "fast/run/make_engine.h"
#include "fast/run/run.h"
#include "fast/step/cell_rule.h"
#include "fast/step/skeleton_engine.h"
#include "scene/base/error.h"
#include "scene/base/index.h"
#include "scene/model/rest_depth.h"
#include "scene/response/find_tips.h"
#include "scene/response/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::fast {
namespace {

/// Measured time of a tick at the deepest instant of the track.
struct Measured {
  std::array<double, stage_count> stage_us{};  ///< medians
  StepStatus status = StepStatus::ok;          ///< of all instants
  double step_us = 0.0;
  int regions = 0;
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
  const scene::RestDepth depth(engine.body(), scene.tool);
  // Runs the track up to that instant, so that regions and friction are as in the scene.
  double deepest_s = times_s.front();
  Measured measured;
  for (const double time_s : times_s) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    measured.status |= engine.step(pose);
    measured.regions = std::max(measured.regions, engine.region_count());
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
  measured.contact = engine.in_contact();
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

std::string fineness_text(const std::optional<ContactCells>& cells) {
  if (!cells || cells->error_rel == 0.0) return "";
  std::string text =
      fmt::format(", {} asked for: load within {:.2g} % of the limit", cells->rule.points, 100.0 * cells->error_rel);
  if (cells->error_rel > cell_tolerance_rel) text += fmt::format(": MORE THAN {:.2g} %", 100.0 * cell_tolerance_rel);
  return text;
}

std::string one_region_text(const scene::Tool& tool) {
  if (!tool.convex()) return "fast.max_regions = 1";
  std::string touch = "a convex body and a convex tool touch in one region";
  if (!tool.mesh) return touch;
  const scene::Bounds bounds = tool.mesh->bounds();
  const double dent_m = scene::convex_tolerance_rel * (bounds.upper_m - bounds.lower_m).norm();
  return touch + fmt::format("; the tool's mesh has no concavity deeper than {:.2g} mm", dent_m * 1e3);
}

/// "2 balls of 2.5 and 3 mm radius".
std::string tips_text(const std::vector<scene::ToolTip>& tips) {
  if (!tips.front().ball()) return fmt::format("a flat tip of {:.4g} mm radius", tips.front().reach_m() * 1e3);
  if (tips.front().line()) {
    return fmt::format("a capsule of {:.4g} mm radius on its side", tips.front().radius_m * 1e3);
  }
  if (tips.size() == 1) return fmt::format("a ball of {:.4g} mm radius", tips.front().radius_m * 1e3);
  std::string radii;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    radii += fmt::format("{}{:.4g}", i == 0 ? "" : i + 1 < tips.size() ? ", " : " and ", tips[i].radius_m * 1e3);
  }
  return fmt::format("{} balls of {} mm radius", tips.size(), radii);
}

/// What the response model was compared with the reference for, or what the track has beyond that. The whole range is
/// in reports/response.md.
std::string checked_text(const scene::Scene& scene, StepStatus status) {
  const CheckedRange checked = checked_range(scene);
  const std::uint32_t beyond =
      static_cast<std::uint32_t>(status | checked.scene) & static_cast<std::uint32_t>(unchecked);
  if (beyond != 0) return "THE TRACK GOES BEYOND: " + status_text(beyond);
  return fmt::format(
      "against the reference: depth to {} of the tip's radius{}, contact radius to {} of the body's size, "
      "{} contact radii from an edge",
      checked.depth_over_radius,
      checked.curvature_rel < 0.01
          ? ""
          : fmt::format(" and {} of the body's smallest radius of curvature", checked.depth_curvature),
      checked.size_rel, checked.edge_over_radius);
}

/// A plan as it is written.
struct Lines {
  scene::Plan plan;
  void models(const char* part, std::string reason, std::string cost = "") {
    plan.push_back({part, true, std::move(reason), std::move(cost)});
  }
  void leaves_out(const char* part, std::string reason) { plan.push_back({part, false, std::move(reason), "nothing"}); }
  void whole(const Measured& measured, const Engine& engine) {
    models("whole step", "all stages", fmt::format("{:.1f} us a tick, measured", measured.step_us));
    models("memory", "model and state, taken before the first tick",
           fmt::format("{:.1f} MB", static_cast<double>(engine.memory_bytes()) / 1e6));
  }
};

/// The one number of the response model that may be fitted.
std::string falloff_text(const scene::Scene& scene) {
  if (scene.body.inclusions.empty()) return "";
  const double falloff_per_m = scene.fast.body_falloff_per_m;
  if (falloff_per_m == 0.0) return ", whatever the contact's size (fast.body_falloff_per_m = 0; `tune` can fit it)";
  return fmt::format(
      ", which falls to 0.71 of itself under a contact of {:.3g} mm radius (fast.body_falloff_per_m = {:.4g} 1/m)",
      1e3 / falloff_per_m, falloff_per_m);
}

scene::Plan response_plan(const scene::Scene& scene) {
  std::unique_ptr<Engine> engine;
  std::string not_there;
  try {
    engine = make_engine(scene);
  } catch (const scene::InputError& error) {
    not_there = error.what();
  }
  const Measured measured = engine ? measure(scene, *engine) : Measured{};
  const auto cost = [&](std::initializer_list<Stage> stages) { return engine ? measured.cost(stages) : ""; };
  const std::vector<scene::ToolTip> tips = scene::tool_tips(scene).tips;
  const scene::LoadGrid grid = scene::load_grid(scene).grid.value();
  Lines lines;
  lines.models("contact detection", tips_text(tips) + " against the exact rest shape", cost({Stage::detection}));
  if (tips.size() > 1) {
    lines.models("several regions",
                 fmt::format("{} parts of the tool touch on this track{}; their forces are found together", tips.size(),
                             engine ? fmt::format(", {} at its instants", measured.regions) : ""),
                 cost({Stage::regions}));
  } else {
    lines.leaves_out("several regions",
                     scene.tool.convex() ? one_region_text(scene.tool) : "one part of the tool touches on this track");
  }
  lines.models(
      "contact force",
      "of a linear half space under the tool's true surface, tabulated over the depth, times a factor of finite "
      "strain that depends on Poisson's ratio; in series with the body's compliance" +
          falloff_text(scene),
      cost({Stage::force}));
  if (const auto& friction = scene.contact.friction) {
    lines.models("friction",
                 fmt::format("sticking up to {:.3g} F_n^{:.3g}, slipping at {:.3g} F_n, from the contact's edge to its "
                             "middle; in series with the body's compliance sideways",
                             friction->K, friction->beta, friction->mu_D),
                 cost({Stage::friction}));
  } else {
    lines.leaves_out("friction", "the scene has no [contact.friction]");
  }
  lines.models(
      "body",
      fmt::format("{} columns of its linear response, {:.3g} mm apart{}",
                  scene::load_kinds(scene).columns(grid.count()), 1e3 * std::max(grid.spacing_m[0], grid.spacing_m[1]),
                  not_there.empty() ? "" : "; " + not_there),
      "computed once by `touchstone prepare`");
  lines.models("surface",
               fmt::format("{} triangles: the half space in closed form and the columns", scene.fast.triangles),
               cost({Stage::interpolation}));
  lines.models("local surface", "points under the tool lie on it", cost({Stage::local_factor}));
  lines.models("normals", "of the deformed surface", cost({Stage::normals}));
  lines.models("pressure", "at recorded instants, not in a step; " + std::string(pressure_errors(scene)));
  lines.models("checked range", checked_text(scene, engine ? measured.status : StepStatus::ok));
  if (engine) lines.whole(measured, *engine);
  lines.leaves_out("time dependence", "the force is static; the track's speed does not enter");
  return lines.plan;
}

}  // namespace

scene::Plan plan(const scene::Scene& scene) {
  if (scene.fast.formulation == scene::Formulation::response) return response_plan(scene);
  SkeletonEngine engine(scene);
  const FastModel& model = engine.model();
  const Measured measured = measure(scene, engine);
  int points = 0;
  for (int i = 0; i < engine.region_count(); ++i) points += nth(engine.state().regions, i).points.count;
  const bool published = scene.fast.formulation == scene::Formulation::published;
  const std::string printed = published ? "as printed" : "corrected", elements = published ? "samples" : "cells";
  const auto held = std::count(model.skeleton.held.begin(), model.skeleton.held.end(), true);

  Lines lines;
  lines.models("contact detection",
               fmt::format("{} {} of the tool, {:.3g} mm apart; {} points inside at the deepest instant",
                           model.tool.count(), elements, model.tool.spacing_m * 1e3, points) +
                   fineness_text(model.cells) +
                   (measured.deepest_m > 0.0 && !measured.contact
                        ? fmt::format("; CONTACT MISSED: the tool is {:.3g} mm deep there but the force is zero; raise "
                                      "fast.tool_samples",
                                      measured.deepest_m * 1e3)
                        : ""),
               measured.cost({Stage::detection}));
  if (model.max_regions > 1) {
    lines.models("several regions",
                 fmt::format("mesh not convex: up to {}, {} at the track's instants, {:.3g} mm or more apart",
                             model.max_regions, measured.regions, scene.contact.r_th_m * 1e3) +
                     (scene.contact.r_th_m < 2.0 * model.tool.spacing_m
                          ? "; ONE CONTACT MAY SPLIT INTO SEVERAL, raise fast.tool_samples"
                          : ""),
                 measured.cost({Stage::regions}));
  } else {
    lines.leaves_out("several regions", one_region_text(scene.tool));
  }
  lines.models("contact force",
               std::string(scene::name_of(scene.contact.law).title) +
                   " law along the direction of deformation, masses " + printed +
                   ", torque about the tool's mass centre",
               measured.cost({Stage::force}));
  if (model.friction) {
    lines.models(
        "friction",
        fmt::format("sticking up to {:.3g} F_n^{:.3g}, slipping at {:.3g} F_n, ", scene.contact.friction->K,
                    scene.contact.friction->beta, scene.contact.friction->mu_D) +
            (published
                 ? "C1 to C4 as printed"
                 : fmt::format("tangential stiffness {:.3g} times the normal one while sticking, by return mapping",
                               scene.contact.friction->stiffness_ratio)),
        measured.cost({Stage::friction}));
  } else {
    lines.leaves_out("friction",
                     "the scene has no [contact.friction]; the force is along the direction of deformation");
  }
  lines.models(
      "beam skeleton",
      fmt::format("{} beams, {} of them ending on the support, anchor points: ", model.skeleton.anchor_m.size(), held) +
          anchors_text(*model.anchors) + "; force split " + printed,
      measured.cost({Stage::skeleton}));
  if (!scene.body.inclusions.empty()) {
    lines.models("inclusions", fmt::format("{}: a beam is cut where it crosses one", scene.body.inclusions.size()),
                 "within the beam skeleton");
  } else {
    lines.leaves_out("inclusions", "the body is of one material, every beam one segment");
  }
  lines.models(
      "surface",
      fmt::format("{} triangles, {} rest points, ", model.surface.triangle_count(), model.surface.vertex_count()) +
          (published ? "lengths and angles interpolated" : "displacement vectors interpolated"),
      measured.cost({Stage::interpolation}));
  if (model.formulas.local_factor()) {
    lines.models(
        "local factor",
        fmt::format("C_n = {:.3g} inside {:.3g} mm of the contact, ", scene.fast.C_n, scene.fast.r_R_m * 1e3) + printed,
        measured.cost({Stage::local_factor}));
  } else {
    lines.leaves_out("local factor", "C_n = 0");
  }
  lines.models("normals", "of the deformed surface", measured.cost({Stage::normals}));
  lines.whole(measured, engine);
  lines.leaves_out("time dependence", "the paper's law is the static force; the track's speed does not enter");
  return lines.plan;
}

}  // namespace touchstone::fast
