#include "fast/run.h"
#include "fast/step.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace touchstone::fast {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// What a tick costs at the track's deepest instant, by the clock.
struct Measured {
  double force_us = 0.0, shape_us = 0.0;
  int points = 0;
  bool contact = false;
};

Measured measure(const scene::Scene& scene, const FastModel& model) {
  const std::vector<double> times_s = scene::instants_s(scene);
  const auto depth_m = [&](double t) {
    return scene::rest_depth_m(*model.body, scene.tool, scene::pose_at(scene.track, t));
  };
  const double deepest_s =
      *std::max_element(times_s.begin(), times_s.end(), [&](double a, double b) { return depth_m(a) < depth_m(b); });
  const scene::Pose pose = scene::pose_at(scene.track, deepest_s);
  FastState state(model);
  using Clock = std::chrono::steady_clock;
  constexpr int ticks = 201;
  std::vector<double> force_us, shape_us;
  for (int i = 0; i < ticks; ++i) {
    const auto begin = Clock::now();
    step_force(model, pose, state);
    const auto published = Clock::now();
    step_shape(model, state);
    const auto end = Clock::now();
    force_us.push_back(std::chrono::duration<double, std::micro>(published - begin).count());
    shape_us.push_back(std::chrono::duration<double, std::micro>(end - published).count());
  }
  const auto median = [](std::vector<double>& sample) {
    std::nth_element(sample.begin(), sample.begin() + ticks / 2, sample.end());
    return sample[ticks / 2];
  };
  return {median(force_us), median(shape_us), state.regions[0].points.count, state.in_contact()};
}

}  // namespace

scene::Plan plan(const scene::Scene& scene) {
  const FastModel model(scene);
  const FastState state(model);
  const Measured measured = measure(scene, model);
  const bool published = scene.fast.formulation == scene::Formulation::published;
  const std::string printed = published ? "as printed" : "corrected";
  const auto held = std::count(model.skeleton.held.begin(), model.skeleton.held.end(), true);

  scene::Plan plan;
  const auto models = [&](const char* part, std::string reason, std::string cost = "") {
    plan.push_back({part, true, std::move(reason), std::move(cost)});
  };
  const auto leaves_out = [&](const char* part, std::string reason) {
    plan.push_back({part, false, std::move(reason), "nothing"});
  };
  models("contact detection",
         text("%d samples of the tool, %.3g mm apart, against the exact rest shape", model.tool.count(),
              model.tool.spacing_m * 1e3),
         measured.contact ? text("%d points inside at the track's deepest instant", measured.points)
                          : "no contact at the track's instants");
  models("contact force", "Duffing law along the direction of deformation, masses " + printed,
         text("%.1f us a tick with detection, measured", measured.force_us));
  models("torque", "moment of the same point forces about the tool's mass centre", "within the contact force");
  models("beam skeleton",
         text("%d beams, %d of them ending on the support, force split ",
              static_cast<int>(model.skeleton.anchor_m.size()), static_cast<int>(held)) +
             printed,
         "one region: one small solve a tick");
  models("surface",
         text("%d triangles, %d rest points, ", model.surface.triangle_count(), model.surface.vertex_count()) +
             (published ? "lengths and angles interpolated" : "displacement vectors interpolated"),
         text("%.1f us a tick with beams and normals, measured", measured.shape_us));
  if (model.formulas.apply_local_factor != nullptr) {
    models("local factor",
           text("C_n = %.3g inside %.3g mm of the contact, ", scene.fast.C_n, scene.fast.r_R_m * 1e3) + printed,
           "within the surface's time");
  } else {
    leaves_out("local factor", "C_n = 0");
  }
  models("memory", "model and state, taken before the first tick",
         text("%.1f MB", static_cast<double>(model.memory_bytes() + state.memory_bytes()) / 1e6));
  leaves_out("friction", "the contact law has none; the force is along the direction of deformation");
  leaves_out("several regions", "a convex body and a ball touch in one region");
  leaves_out("inclusions", "the body is of one material, every beam one segment");
  leaves_out("time dependence", "the paper's law is the static force; the track's speed does not enter");
  return plan;
}

}  // namespace touchstone::fast
