#include "reference/solver.h"

#include "reference/run/identity.h"
#include "reference/run/model_choice.h"
#include "reference/run/run.h"
#include "reference/run/store.h"
#include "reference/tool/distance_grid.h"
#include "reference/tool/tool_distance.h"
#include "scene/files.h"

#include <iomanip>
#include <sstream>

namespace touchstone::reference {
namespace {

using scene::Scene;

/// Displacement unknowns of a level, without counting the few prescribed ones out.
std::string expected_unknowns(const Scene& scene, const ModelChoice& choice, int level) {
  const int nodes = choice.dim == 2 ? level_mesh<2>(scene, choice, level).node_count()
                                    : level_mesh<3>(scene, choice, level).node_count();
  return "at most " + std::to_string(choice.dim * nodes) + " displacement unknowns";
}

template <class Add>
void add_tool_line(const Scene& scene, const Add& add) {
  std::ostringstream how;
  how << std::setprecision(3);
  if (scene.tool.shape == scene::ToolShape::mesh) {
    how << "signed distance on a grid of " << 1e3 * grid_spacing_m(*scene.tool.mesh)
        << " mm with a tricubic spline; sharp edges are rounded over about as much";
  } else {
    how << "exact signed distance";
    if (scene.tool.shape == scene::ToolShape::box) {
      how << " of a box with edges rounded by " << 0.5e3 * box_edge_share * scene.tool.size_m.minCoeff()
          << " mm: sharp ones have unbounded pressure";
    }
  }
  add("tool", true, how.str());
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
  std::ostringstream nu;
  nu << "nu = " << scene.body.material.poissons_ratio << "; "
     << (scene.body.material.poissons_ratio == 0.5 ? "incompressible, the pressure keeps the volume"
                                                   : "the same mixed element serves every nu, so nothing locks");
  add("pressure unknowns", true, nu.str(), "eliminated cell by cell, none in the global matrix");
  if (scene.contact.friction) {
    add("friction", true,
        "|t| <= m N at every node, m of its region: stuck m F_n = K F_n^beta, sliding m = mu_D, but no more than stuck",
        "every load step is an increment of the path");
  } else {
    add("friction", false, "the scene has none");
  }
  add("several contact regions", !scene.tool.convex(),
      scene.tool.convex() ? "a convex tool touches a convex body once"
                          : "touching nodes nearer than fast.r_th_m, or of one cell face, are one region");
  add_tool_line(scene, add);
  const std::size_t inclusions = scene.body.inclusions.size();
  if (inclusions == 0) {
    add("inclusions", false, "the body is of one material");
  } else {
    add("inclusions", true,
        std::to_string(inclusions) + " of another material, each integration point has the one it lies in",
        "small cells at their surfaces");
  }
  const int levels = scene.reference.levels.value_or(3);
  std::ostringstream uncertainty;
  if (!scene.reference.levels) {
    uncertainty << "from 3 refinement levels or more, until force and shape are known to " << scene.reference.error;
  } else if (levels >= 3) {
    uncertainty << "from " << levels << " refinement levels";
  } else {
    uncertainty << "fewer than three levels: unknown";
  }
  add("uncertainty", levels >= 3, uncertainty.str());
  for (int level = 0; level < levels; ++level) {
    std::ostringstream size;
    size << "cells of " << std::setprecision(3) << 1e3 * element_size_m(scene, choice, level)
         << " mm at the deepest contact's rim";
    add(("level " + std::to_string(level + 1)).c_str(), true, size.str(), expected_unknowns(scene, choice, level));
  }
  return plan;
}

Result solve(const Scene& scene, const Eigen::Matrix3Xd& rest_points_m, const Options& options) {
  if (std::vector<scene::Fault> faults = unsupported(scene); !faults.empty())
    throw scene::InputError(std::move(faults));
  scene::require_writable(options.store / content_key(scene), "--store");
  const ModelChoice choice = choose_model(scene);
  return run(scene, choice, rest_points_m, options);
}

}  // namespace touchstone::reference
