#include "compare/gate/gate_figures.h"

#include "compare/calculix/calculix.h"
#include "compare/errors/figures.h"
#include "compare/gate/stored_reference.h"
#include "compare/model/judge.h"
#include "compare/model/registry.h"
#include "compare/solve/reference_run.h"
#include "reference/verification/closed_forms.h"
#include "scene/input/scene_io.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace touchstone::compare {
namespace {

using std::filesystem::path;

/// A temporary folder for solves that must not use stored results.
class WorkFolder {
 public:
  WorkFolder() : path_(std::filesystem::temp_directory_path() / ("touchstone-gate-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
  }
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  [[nodiscard]] const path& folder() const noexcept { return path_; }

 private:
  path path_;
};

/// Whether the top of the body is plane; then a small enough contact behaves as on a half space.
bool flat_top(const scene::Body& body) {
  if (body.shape == scene::BodyShape::box) return true;
  if (body.shape != scene::BodyShape::revolution || !body.profile.arc_radius_m.empty()) return false;
  const auto& rz_m = body.profile.rz_m;
  return rz_m.size() >= 2 && rz_m[rz_m.size() - 2].y() == rz_m.back().y();
}

/// Force of a ball on a half space in small strain [N]; nothing for other scenes.
std::optional<double> half_space_force_n(const scene::Scene& scene, double depth_m) {
  if (scene.tool.shape != scene::ToolShape::sphere || !flat_top(scene.body) || !scene.body.inclusions.empty() ||
      scene.reference.kinematics != scene::Kinematics::small) {
    return std::nullopt;
  }
  return verification::hertz(scene.body.material.contact_modulus_pa(), scene.tool.radius_m, depth_m).force_n;
}

std::size_t deepest(const scene::Instants& instants) {
  const auto at = std::ranges::max_element(instants, {}, &scene::InstantRecord::depth_m);
  return static_cast<std::size_t>(std::distance(instants.begin(), at));
}

ModelEntry model_of(const GateFile& file, const scene::Scene& scene, const std::vector<ModelList>& models) {
  return file.model.empty() ? fast_model(scene) : find_model({.scene = scene}, file.model, models);
}

scene::Figures model_figures(const GateFile& file, const scene::Scene& own, const scene::Scene& changed,
                             const std::vector<ModelList>& models) {
  std::optional<reference::Result> stored;
  if (!file.reference.empty()) stored = stored_reference(file.reference, own, rest_surface(own));
  const ModelEntry entry = model_of(file, changed, models);
  const std::unique_ptr<ContactModel> model = entry.set_up(changed);
  scene::Answer answer = unanswered(changed);
  model->answer(answer);
  // A fault of the fast model's own steps is a figure, not an error.
  if (!entry.own && !model->trouble().empty()) throw Unavailable(model->trouble());
  if (stored) return make_figures(errors_of(entry, changed, answer, stored->instants), *stored, model->figures());
  scene::Figures figures = model->figures();
  if (entry.gives_force) figures.push_back({"force.peak_fast_n", peak_n(answer.instants), "", "N"});
  return figures;
}

/// Distance of the new solution from the stored one.
void add_resolved(const reference::Result& result, const reference::Result& stored,
                  const std::vector<double>& vertex_area_m2, scene::Figures& figures) {
  if (result.instants.size() != stored.instants.size()) throw std::logic_error("another number of instants");
  double force_n = 0.0, error = 0.0, scale = 0.0;
  for (std::size_t t = 0; t < result.instants.size(); ++t) {
    const scene::InstantRecord &now = result.instants[t], &then = stored.instants[t];
    const double off_n = (now.force_n() - then.force_n()).norm();
    if (std::isnan(off_n) || off_n > force_n) force_n = off_n;
    for (std::size_t i = 0; i < vertex_area_m2.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const scene::Vec3 then_m = then.displacement_m.col(column);
      error += vertex_area_m2[i] * (now.displacement_m.col(column) - then_m).squaredNorm();
      scale += vertex_area_m2[i] * then_m.squaredNorm();
    }
  }
  figures.push_back({"resolved.force_rel", force_n / peak_n(stored.instants), "", ""});
  figures.push_back({"resolved.shape_rel_l2", std::sqrt(error / scale), "", ""});
}

scene::Figures reference_side_figures(const GateFile& file, const scene::Scene& own, const scene::Scene& changed) {
  const scene::Surface surface = rest_surface(own);
  std::optional<reference::Result> stored;
  if (!file.reference.empty()) stored = stored_reference(file.reference, own, surface);
  const WorkFolder work;
  ReferenceOptions options;
  options.store = work.folder();
  const reference::Result result = solve_with_progress(changed, surface, options, true);
  scene::Figures figures = reference_figures(result, reference_quality(result.instants));
  figures.push_back({"reference.force_peak_n", peak_n(result.instants), "", "N"});
  const std::size_t at = deepest(result.instants);
  if (const auto hertz_n = half_space_force_n(own, result.instants[at].depth_m)) {
    const std::string key = "hertz.force_rel";
    figures.push_back({key, result.instants[at].force_n().norm() / *hertz_n - 1.0, "", ""});
    figures.push_back(
        {key + std::string(uncertainty_suffix), result.instants[at].force_uncertainty_n / *hertz_n, "", ""});
  }
  if (stored) add_resolved(result, *stored, surface.vertex_area_m2, figures);
  return figures;
}

scene::Figures second_code_figures(const scene::Scene& own, const scene::Scene& changed) {
  const WorkFolder work;
  const reference::Deck deck = reference::calculix_deck(own, {.level = 1});
  std::filesystem::create_directories(work.folder());
  scene::write_file(work.folder() / "deck.inp", deck.text);
  const CalculixRun run = run_calculix(work.folder(), "deck", deck);
  if (run.steps.size() != deck.instants.size()) {
    throw std::runtime_error(
        fmt::format("CalculiX ended after {} of {} steps", run.steps.size(), deck.instants.size()));
  }
  ReferenceOptions options;
  options.store = work.folder() / "store";
  scene::Surface surface;
  surface.points_m = deck.surface_points_m;
  const reference::Result result = solve_with_progress(changed, surface, options, true);
  const auto at = static_cast<int>(deepest(result.instants));
  const auto step = std::ranges::find(deck.instants, at) - deck.instants.begin();
  if (step == std::ssize(deck.instants)) throw std::logic_error("the change touches at another instant");
  const CalculixStep& theirs = run.steps[step];
  const scene::InstantRecord& ours = result.instants[at];
  const double force_n = theirs.force_n.norm(), largest_m = longest_m(theirs.displacement_m);
  const std::string force = "second_code.force_rel", shape = "second_code.surface_rel";
  const std::string uncertainty(uncertainty_suffix);
  return {{force, ours.force_n().norm() / force_n - 1.0, "", ""},
          {force + uncertainty, result.instants[at].force_uncertainty_n / force_n, "", ""},
          {shape, longest_m(ours.displacement_m - theirs.displacement_m) / largest_m, "", ""},
          {shape + uncertainty, result.instants[at].displacement_uncertainty_m.maxCoeff() / largest_m, "", ""}};
}

}  // namespace

scene::Surface rest_surface(const scene::Scene& scene) {
  return scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
}

double peak_n(const scene::Instants& instants) {
  double peak = 0.0;
  for (const scene::InstantRecord& record : instants) {
    const double force_n = record.force_n().norm();
    if (std::isnan(force_n) || force_n > peak) peak = force_n;
  }
  return peak;
}

std::vector<scene::Fault> unsupported_by_gate(const GateFile& file, const scene::Scene& scene,
                                              const std::vector<ModelList>& models) {
  std::vector<scene::Fault> faults;
  if (file.run != GateRun::fast || !file.reference.empty()) faults = reference::unsupported(scene);
  if (file.run == GateRun::second_code && faults.empty()) faults = reference::unsupported_in_deck(scene);
  if (faults.empty()) (void)model_of(file, scene, models);
  return faults;
}

scene::Scene scene_of(const GateFile& file, const std::vector<std::string>& change) {
  std::vector<std::string> settings = file.set;
  settings.insert(settings.end(), change.begin(), change.end());
  return scene::load_scene(file.scene_file, settings);
}

scene::Figures gate_figures(const GateFile& file, const std::vector<std::string>& change,
                            const std::vector<ModelList>& models) {
  const scene::Scene own = scene_of(file), changed = scene_of(file, change);
  switch (file.run) {
    case GateRun::fast:
      return model_figures(file, own, changed, models);
    case GateRun::reference:
      return reference_side_figures(file, own, changed);
    case GateRun::second_code:
      return second_code_figures(own, changed);
  }
  return {};
}

}  // namespace touchstone::compare
