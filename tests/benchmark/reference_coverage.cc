// Error of the reference's meshes against a much finer solution, and whether the reported uncertainty holds it:
//   reference_coverage SCENE STORE FIRST LAST TRUTH_SHARE TRUTH_LEVELS [in-space] [KEY=VALUE...]
// Prints the answers on FIRST to LAST meshes of the scene's own refinement. The finer solution has half the cell size
// under the tool on its first mesh, reference.adaptive_share = TRUTH_SHARE (0: the fixed family) and TRUTH_LEVELS
// meshes. STORE keeps both, so that a second run only reads. in-space solves the answers of an axisymmetric scene on
// meshes of a quarter of the body, whose finer solution is in the meridian plane.
#include "reference/run/model_choice.h"
#include "reference/run/run.h"
#include "reference/run/uncertainty.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "scene/shape/surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

namespace {

using namespace touchstone;
using namespace touchstone::reference;

/// One answer beside the finer one.
void print(const Result& answer, const Result& truth, const std::vector<double>& area_m2) {
  const std::vector<bool> deep = deep_instants(answer.instants);
  double force_error_rel = 0.0, last_rel = 0.0, last_band_rel = 0.0, squared_error = 0.0, squared_norm = 0.0,
         cpu_s = 0.0;
  int instants = 0, held = 0, points = 0, points_held = 0, axes_held = 0;
  double axis_error_rel = 0.0, axis_band_rel = 0.0;
  for (const LevelRecord& level : answer.levels) cpu_s += level.cpu_s;
  const Eigen::VectorXd area = areas_or_ones(area_m2, answer.instants[0].displacement_m.cols());
  for (std::size_t i = 0; i < answer.instants.size(); ++i) {
    const auto& one = answer.instants[i];
    const Eigen::VectorXd error_m =
        (one.displacement_m - truth.instants[i].displacement_m).colwise().norm().transpose();
    squared_error += error_m.cwiseAbs2().dot(area);
    squared_norm += one.displacement_m.colwise().squaredNorm().transpose().dot(area);
    if (!deep[i]) continue;
    const double force_n = truth.instants[i].force_n().norm();
    const double error_n = (one.force_n() - truth.instants[i].force_n()).norm();
    ++instants;
    held += error_n <= one.force_uncertainty_n ? 1 : 0;
    force_error_rel = std::max(force_error_rel, error_n / force_n);
    last_rel = error_n / force_n;
    last_band_rel = one.force_uncertainty_n / force_n;
    for (int axis = 0; axis < 2; ++axis) {
      const double half_m = truth.instants[i].contact_half_axes_m[axis];
      const double axis_error_m = std::abs(one.contact_half_axes_m[axis] - half_m);
      axis_error_rel = std::max(axis_error_rel, axis_error_m / half_m);
      axis_band_rel = std::max(axis_band_rel, one.contact_half_axes_uncertainty_m[axis] / half_m);
      axes_held += axis_error_m <= one.contact_half_axes_uncertainty_m[axis] ? 1 : 0;
    }
    points += static_cast<int>(error_m.size());
    points_held += static_cast<int>((error_m.array() <= one.displacement_uncertainty_m.array() + 1e-9).count());
  }
  std::printf(
      "%zu meshes | %6d | %7.1f | %.4f | %.4f | %d/%d | %.4f | %.4f | %.4f | %.4f | %.1f | "
      "%.4f | %.4f | %d/%d\n",
      answer.levels.size(), answer.levels.back().unknowns, cpu_s, 100.0 * force_error_rel,
      100.0 * answer.force_uncertainty_rel.value_or(NAN), held, instants, 100.0 * last_rel, 100.0 * last_band_rel,
      100.0 * std::sqrt(squared_error / squared_norm), 100.0 * answer.shape_uncertainty_rel.value_or(NAN),
      100.0 * points_held / points, 100.0 * axis_error_rel, 100.0 * axis_band_rel, axes_held, 2 * instants);
  std::fflush(stdout);
}

int measure(int count, char** arguments) {
  const bool in_space = count > 7 && std::string(arguments[7]) == "in-space";
  const std::vector<std::string> overrides(arguments + (in_space ? 8 : 7), arguments + count);
  const scene::Scene scene = scene::load_scene(arguments[1], overrides);
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  Options options;
  options.store = arguments[2];
  options.rest_area_m2 = surface.vertex_area_m2;
  const double share = std::atof(arguments[5]);
  const auto solved = [&](scene::Scene one, int levels) {
    one.reference.levels = levels;
    return solve(one, surface.points_m, options);
  };
  scene::Scene finer = scene;
  const ModelChoice choice = choose_model(scene);
  const auto solved_in_space = [&](scene::Scene one, int levels) {
    one.reference.levels = levels;
    ModelChoice quarter = choice;
    quarter.dim = 3;
    follow_inclusions(one, quarter);
    Options apart = options;
    apart.store /= "in-space";  // the scene's key is that of the plane
    return run(one, quarter, surface.points_m, apart, scene::Stopwatch());
  };
  finer.reference.element_size_m = 0.5 * element_size_m(scene, choice, 0);
  finer.reference.adaptive_share = share > 0.0 ? std::optional(share) : std::nullopt;
  const Result truth = solved(finer, std::atoi(arguments[6]));
  std::printf("%s: finer solution %d unknowns, force %.6g N, uncertainty of force %.3g %%, of shape %.3g %%\n",
              scene.name.c_str(), truth.levels.back().unknowns, truth.instants.back().force_n().norm(),
              100.0 * truth.force_uncertainty_rel.value_or(NAN), 100.0 * truth.shape_uncertainty_rel.value_or(NAN));
  std::printf(
      "meshes | unknowns | processor time [s] | largest force error [%%] | uncertainty [%%] | instants held | "
      "at the last instant: error [%%] | uncertainty [%%] | shape error [%%] | uncertainty [%%] | points held [%%] | "
      "largest error of a half axis [%%] | uncertainty [%%] | half axes held\n");
  for (int levels = std::atoi(arguments[3]); levels <= std::atoi(arguments[4]); ++levels) {
    print(in_space ? solved_in_space(scene, levels) : solved(scene, levels), truth, surface.vertex_area_m2);
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 7) {
    std::fprintf(stderr, "usage: reference_coverage SCENE STORE FIRST LAST TRUTH_SHARE TRUTH_LEVELS [KEY=VALUE...]\n");
    return 2;
  }
  try {
    return measure(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
