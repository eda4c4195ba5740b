#include "reference/solver.h"

#include "reference/linear/ranks.h"
#include "reference/mesh/mesh_limit.h"
#include "reference/run/adaptive.h"
#include "reference/run/cost.h"
#include "reference/run/identity.h"
#include "reference/run/model_choice.h"
#include "reference/run/run.h"
#include "reference/run/sensitivity.h"
#include "reference/run/store.h"
#include "reference/tool/distance_grid.h"
#include "reference/tool/tool_distance.h"
#include "scene/base/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace touchstone::reference {
namespace {

using scene::Scene;

/// For example "20352 unknowns, about 0.4 GiB and 2 min".
std::string cost_text(double unknowns, const Cost& cost) {
  return std::to_string(std::lround(unknowns)) + " unknowns, about " + memory_text(cost.memory_bytes) + " and " +
         duration_text(cost.seconds);
}

/// Cost of each level, and of all levels with the sensitivities.
template <int dim>
void add_level_lines(const Scene& scene, const ModelChoice& choice, int levels, scene::Plan& plan) {
  const auto body = scene::body_shape(scene.body);
  const std::vector<double> times_s = scene::instants_s(scene);
  std::vector<double> depths_m;
  for (const double time_s : times_s) {
    depths_m.push_back(scene::rest_depth_m(*body, scene.tool, scene::pose_at(scene.track, time_s)));
  }
  const auto touches = [](double depth_m) { return depth_m > 0.0; };
  const auto load_steps = static_cast<int>(std::count_if(depths_m.begin(), depths_m.end(), touches));
  Cost all;
  const auto add = [&](const MeshWork& work) {
    const Cost cost = expected_cost(work, ranks::threads());
    all.seconds += cost.seconds;
    all.memory_bytes = std::max(all.memory_bytes, cost.memory_bytes);
    return cost_text(work.unknowns, cost);
  };
  std::optional<Discretisation<dim>> coarsest;
  for (int level = 0; level < levels; ++level) {
    const bool divided = scene.reference.adaptive_share && level > 0;
    const std::string size =
        divided ? "cells of the coarser mesh divided where its error is; the number of unknowns is a guess"
                : fmt::format("cells of {:.3g} mm at the deepest contact's rim",
                              1e3 * element_size_m(scene, choice, level));
    const std::string part = "mesh " + std::to_string(level + 1);
    try {
      Discretisation<dim> mesh = divided ? *coarsest : level_mesh<dim>(scene, choice, level);
      plan.push_back(
          {part, true, size,
           add({.dim = dim,
                .unknowns = unknowns_of(mesh) * (divided ? std::pow(adaptive_growth(scene, dim), level) : 1.0),
                .load_steps = load_steps,
                .friction = scene.contact.friction.has_value()})});
      if (level == 0) coarsest = std::move(mesh);
    } catch (const MeshTooLarge& failure) {
      plan.push_back({part, false, failure.what(), ""});
      return;
    }
  }
  const bool uncertainty = levels >= 3;
  if (uncertainty) {
    const auto until = std::max_element(depths_m.begin(), depths_m.end()) + 1;
    const auto touching = static_cast<int>(std::count_if(depths_m.begin(), until, touches));
    for (const SensitivityWork& one : missing_sensitivities<dim>(scene, choice, *coarsest, touching, nullptr)) {
      add(one.work);
    }
  }
  plan.push_back({"all meshes", true,
                  fmt::format("{} load steps in contact on each mesh{}; time of {} thread{} on an idle AMD EPYC at 2.6 "
                              "GHz, within a factor of two",
                              load_steps, uncertainty ? ", and the sensitivities" : "", ranks::threads(),
                              ranks::threads() == 1 ? "" : "s"),
                  "about " + memory_text(all.memory_bytes) + " and " + duration_text(all.seconds)});
}

template <class Add>
void add_tool_line(const Scene& scene, const Add& add) {
  std::string how;
  if (scene.tool.shape == scene::ToolShape::mesh) {
    how = fmt::format(
        "signed distance on a grid of {:.3g} mm with a tricubic spline; sharp edges are rounded over about as much",
        1e3 * grid_spacing_m(*scene.tool.mesh));
  } else {
    how = "exact signed distance";
    if (scene.tool.shape == scene::ToolShape::box) {
      how += fmt::format(" of a box with edges rounded by {:.3g} mm: sharp ones have unbounded pressure",
                         0.5e3 * box_edge_share * scene.tool.size_m.minCoeff());
    }
  }
  add("tool", true, how);
}

}  // namespace

std::vector<scene::Fault> unsupported(const Scene& scene) { return unsupported_parts(scene); }

std::string content_key(const Scene& scene) { return Store::key(identity_text(scene)); }

scene::Plan plan(const Scene& scene) {
  const ModelChoice choice = choose_model(scene);
  const int mirrors = (choice.mirror_x ? 1 : 0) + (choice.mirror_y ? 1 : 0);
  scene::Plan plan;
  const auto add = [&](const char* part, bool modelled, const std::string& reason, const std::string& cost = {}) {
    plan.push_back({part, modelled, reason, cost});
  };
  if (choice.dim == 2) {
    add("axial symmetry", true, "body and tool are of revolution about one axis: one meridian plane is the whole body");
  } else if (mirrors > 0) {
    add(mirrors == 2 ? "quarter symmetry" : "half symmetry", true,
        mirrors == 2 ? "body, inclusions, tool and track share the planes x = 0 and y = 0"
                     : "body, inclusions, tool and track share one of the planes x = 0 and y = 0",
        mirrors == 2 ? "a quarter of the unknowns" : "half of the unknowns");
  } else {
    add("symmetry", false, "body, inclusions, tool and track share no symmetry plane", "the whole body is meshed");
  }
  const bool finite = scene.reference.kinematics == scene::Kinematics::finite;
  add("finite strain", finite,
      finite ? "neo-Hookean, deformed geometry in contact"
             : "reference.kinematics is \"small\": linear elasticity, gap along the rest normal");
  const double nu = scene.body.material.poissons_ratio;
  add("pressure unknowns", true,
      fmt::format("nu = {:g}; {}", nu,
                  nu == 0.5 ? "incompressible, enforced by the pressure"
                            : "the same mixed element for every nu, without locking"),
      "eliminated cell by cell, none in the global matrix");
  if (scene.contact.friction) {
    add("friction", true,
        "|t| <= m N at every node, m of its region: sticking m F_n = K F_n^beta, slipping m = mu_D, at most the static "
        "limit",
        "every load step is an increment of the path");
  } else {
    add("friction", false, "the scene has none");
  }
  add("several contact regions", !scene.tool.convex(),
      scene.tool.convex() ? "a convex tool touches a convex body once"
                          : "contact nodes nearer than contact.r_th_m, or of one cell face, are one region");
  add_tool_line(scene, add);
  const std::size_t inclusions = scene.body.inclusions.size();
  if (inclusions == 0) {
    add("inclusions", false, "the body is of one material");
  } else {
    add("inclusions", true,
        std::to_string(inclusions) + " of another material, " +
            (choice.follows() ? "whose surfaces the cells of all meshes follow"
                              : "each integration point has the material at its place, since " + choice.why_cut),
        "small cells at their surfaces");
  }
  if (!scene.probes.empty()) {
    std::string names;
    for (const scene::Probe& probe : scene.probes) names += (names.empty() ? "" : ", ") + probe.name;
    add("probes", true, "displacement, stress and pressure with their uncertainty in probes.csv at " + names,
        "read from the solutions");
  }
  const int levels = scene.reference.levels.value_or(3);
  std::string uncertainty = "unknown with fewer than three meshes";
  if (!scene.reference.levels) {
    uncertainty =
        fmt::format("from 3 meshes or more, until force and shape are known to {:g} %", 100.0 * scene.reference.error);
  } else if (levels >= 3) {
    uncertainty = fmt::format("from {} meshes", levels);
  }
  add("uncertainty", levels >= 3, uncertainty);
  if (choice.dim == 2) {
    add_level_lines<2>(scene, choice, levels, plan);
  } else {
    add_level_lines<3>(scene, choice, levels, plan);
  }
  return plan;
}

Result solve(const Scene& scene, const Eigen::Matrix3Xd& rest_points_m, const Options& options) {
  if (std::vector<scene::Fault> faults = unsupported(scene); !faults.empty())
    throw scene::InputError(std::move(faults));
  scene::require_writable(options.store / content_key(scene), "--store");
  const scene::Stopwatch begin;
  const ModelChoice choice = choose_model(scene);
  return run(scene, choice, rest_points_m, options, begin);
}

}  // namespace touchstone::reference
