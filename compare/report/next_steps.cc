#include "compare/report/next_steps.h"

#include "compare/errors/measure.h"
#include "compare/format/text.h"
#include "compare/input/tuning_study.h"
#include "compare/model/skeleton_model.h"
#include "compare/report/comparison_drawings.h"
#include "compare/report/model_table.h"
#include "fast/command/command_line.h"
#include "fast/step/state.h"
#include "scene/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

/// Smaller errors need no better constants.
constexpr double small_error = 0.05;

/// A trial is suggested if the remaining error is at most this fraction of the present one.
constexpr double worth_it = 0.8;

/// No further trials after this total time [s].
constexpr double trial_time_s = 5.0;

bool has(std::uint32_t status, fast::StepStatus bit) { return (status & static_cast<std::uint32_t>(bit)) != 0; }

/// The two errors by which a trial is judged, as in Errors.
struct Trial {
  double force_nrmse = 0.0, shape_rel_l2 = 0.0;
  std::uint32_t status = 0;
};

Trial tried(const scene::Scene& changed, const reference::Result& result, const Errors& errors) {
  const fast::Run run = fast_model().set_up(changed)->track().value();
  MeanSquares force;
  SquareSums shape;
  for (std::size_t t = 0; t < run.instants.size(); ++t) {
    const scene::InstantRecord &f = run.instants[t], &r = result.instants[t];
    force.add((f.force_n() - r.force_n()).norm(), 0.0);
    for (Eigen::Index i = 0; i < f.displacement_m.cols(); ++i) {
      shape.add(run.surface.vertex_area_m2[static_cast<std::size_t>(i)],
                (f.displacement_m.col(i) - r.displacement_m.col(i)).norm(), 0.0, r.displacement_m.col(i).norm());
    }
  }
  const double infinite = std::numeric_limits<double>::infinity();
  return {force.over(errors.force_peak_reference_n).value.value_or(infinite), shape.relative().value.value_or(infinite),
          run.status};
}

/// Two significant digits, as a user would type them.
std::string typed(double value) { return fmt::format("{:.2g}", value); }

/// A tuning study that trains on this scene, from its folder or the folder "studies" beside that.
std::filesystem::path tuning_study_of(const std::filesystem::path& scene_file) {
  const std::filesystem::path here = scene_file.parent_path();
  for (const std::filesystem::path& folder : {here, here.parent_path() / "studies"}) {
    std::error_code none;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, none)) {
      if (entry.path().extension() == ".toml") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      try {
        const TuningStudy study = load_tuning_study(file, {});
        const bool trains = std::any_of(study.training.begin(), study.training.end(),
                                        [&](const auto& contact) { return contact.scene.name == scene_file.stem(); });
        if (trains) return file;
      } catch (const scene::InputError&) {
        continue;  // an unfinished file in the same folder
      }
    }
  }
  return {};
}

class Finder {
 public:
  Finder(const scene::Scene& scene, const fast::Run& run, const reference::Result& result, const Errors& errors,
         const Call& call)
      : scene_(scene), run_(run), result_(result), errors_(errors), call_(call) {}

  std::vector<NextStep> find() {
    if (errors_.force_peak_reference_n == 0.0) {
      nearer();
      return std::move(steps_);
    }
    less_deep();
    more_regions();
    known_better();
    if (scene_.fast.formulation == scene::Formulation::response) return std::move(steps_);  // no skeleton
    other_beams();
    area_law();
    tuning();
    return std::move(steps_);
  }

 private:
  void add(std::string why, std::string command = "") { steps_.push_back({std::move(why), std::move(command)}); }

  void nearer() {
    const auto nearest =
        std::min_element(result_.instants.begin(), result_.instants.end(),
                         [&](const auto& a, const auto& b) { return separation_m(a) < separation_m(b); });
    if (errors_.depth_max_m > 0.0 || !(separation_m(*nearest) > 0.0)) return;
    add(fmt::format("Move the track nearer to the body: at its nearest, at {}{}s, the tool is {} away.",
                    number_text(nearest->time_s), no_break, quantity_text(separation_m(*nearest), "m")));
  }

  /// Only the fast model may have it.
  [[nodiscard]] double separation_m(const scene::ReferenceInstant& record) const {
    const auto index = static_cast<std::size_t>(&record - result_.instants.data());
    return std::max(record.separation_m, run_.instants[index].separation_m);
  }

  void less_deep() {
    if (has(run_.status, fast::StepStatus::depth_limited)) {
      add("Press less deeply: beyond half of the body's thickness the fast model limits its depth.");
    }
    if (has(run_.status, fast::StepStatus::law_saturated)) {
      add("Press less deeply, or raise contact.k3_n_per_m3: beyond its peak the contact law keeps the peak force.");
    }
  }

  void more_regions() {
    if (!has(run_.status, fast::StepStatus::regions_full)) return;
    add("Allow more contact regions.",
        again(fmt::format(" --set fast.max_regions={}", std::min(64, 2 * scene_.fast.max_regions))));
  }

  void known_better() {
    const std::optional<double> force = force_known_to(errors_);
    const bool unknown = !force || !errors_.shape_rel_l2.uncertainty;
    const bool hidden = !errors_.force_nrmse.distinguishable() || !errors_.shape_rel_l2.distinguishable();
    if (!unknown && !hidden) return;
    const reference::EndedBy ended_by = result_.refinement.ended_by;
    Call more = call_;
    more.reference.levels.reset();
    if (scene_.reference.levels && *scene_.reference.levels < 3) {
      add("Solve the reference on three meshes. With fewer its uncertainty is unknown.", command_text(more, ""));
    } else if (ended_by == reference::EndedBy::sensitivity || ended_by == reference::EndedBy::convergence) {
      return;  // the verdict says why finer meshes do not help
    } else if ((unknown || *force > 0.002) && ended_by == reference::EndedBy::memory) {
      add("A finer mesh needs more memory than is allowed. On a machine that has it, allow it with --memory-gib; "
          "otherwise make the first mesh coarser with reference.element_size_m.");
    } else if ((unknown || *force > 0.002) && ended_by == reference::EndedBy::time) {
      more.reference.minutes = 4.0 * call_.reference.minutes.value_or(default_minutes);
      add("Give the reference more time. Finished load steps are kept.", command_text(more, ""));
    } else if (!unknown && *force > 0.002) {
      const double half = 0.5 * std::max(*force, *errors_.shape_rel_l2.uncertainty);
      more.reference.error = std::stod(typed(std::clamp(half, 1e-4, 0.5)));
      add("Refine the reference: an error is no larger than its uncertainty.", command_text(more, ""));
    }
  }

  /// Stiffer beams if anchor points were limited, else the stiffness with the smallest shape error.
  void other_beams() {
    const bool limited = has(run_.status, fast::StepStatus::anchors_limited);
    const double before = errors_.shape_rel_l2.value.value_or(0.0);
    if (!limited && !(errors_.shape_rel_l2.distinguishable() && before > 0.5)) return;
    std::optional<std::pair<double, Trial>> best;
    const std::vector<double> powers =
        limited ? std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8} : std::vector<double>{1, 2, 3, -1, -2};
    for (const double power : powers) {
      if (!time_left()) break;
      scene::Scene changed = scene_;
      const double factor = std::pow(4.0, power);
      changed.fast.s_c_m2 = std::stod(typed(factor * scene_.fast.s_c_m2));
      const Trial trial = tried(changed, result_, errors_);
      if (has(trial.status, fast::StepStatus::anchors_limited)) continue;
      if (!best || trial.shape_rel_l2 < best->second.shape_rel_l2) best = {changed.fast.s_c_m2, trial};
      // Beams only need to be stiff enough; much stiffer ones would not move at all.
      if (limited && trial.shape_rel_l2 > best->second.shape_rel_l2) break;
    }
    if (!best || (!limited && best->second.shape_rel_l2 > worth_it * before)) return;
    const bool stiffer = best->first > scene_.fast.s_c_m2;
    add(fmt::format("Take {} beams. Tried: the shape error goes from {} to {}{}.", stiffer ? "stiffer" : "softer",
                    percent_text(before), percent_text(best->second.shape_rel_l2),
                    limited ? ", and no anchor displacement is limited" : ""),
        again(" --set fast.s_c_m2=" + typed(best->first)));
  }

  void area_law() {
    const double before = errors_.force_nrmse.value.value_or(0.0);
    if (scene_.contact.law != scene::ContactLaw::duffing || !errors_.force_nrmse.distinguishable() ||
        before < small_error || !time_left())
      return;
    const scene::Scene changed = with_untuned_area_law(scene_);
    const Trial trial = tried(changed, result_, errors_);
    if (!(trial.force_nrmse < worth_it * before)) return;
    const std::string name = "area-aware.toml";
    Call untuned = call_;
    untuned.compare.parameters = call_.folder / name;
    steps_.push_back(
        {fmt::format(
             "Take the area-aware law with the material's modulus and stiff beams. Tried: force error from {} to {}, "
             "shape error from {} to {}.",
             percent_text(before), percent_text(trial.force_nrmse),
             percent_text(errors_.shape_rel_l2.value.value_or(0.0)), percent_text(trial.shape_rel_l2)),
         command_text(untuned, " --out " + fast::shell_word(call_.folder.string() + "-area-aware")), name,
         fmt::format(
             "# The area-aware law F = k1 D. Its constant follows from the material, s_c from the body's size:\n"
             "# nothing is tuned.\n"
             "[contact]\nlaw = \"area_aware\"\nk1_per_radius_n_per_m2 = {:.6g}\nk3_n_per_m3 = 0.0\n\n"
             "[fast]\ns_c_m2 = {:.6g}\n",
             changed.contact.k1_per_radius_n_per_m2, changed.fast.s_c_m2)});
  }

  void tuning() {
    const auto matters = [](const Measure& error) {
      return error.value.value_or(0.0) > small_error && error.distinguishable();
    };
    if (!call_.compare.parameters.empty() || (!matters(errors_.force_nrmse) && !matters(errors_.shape_rel_l2))) return;
    if (const std::filesystem::path study = tuning_study_of(call_.scene_file); !study.empty()) {
      add("Tune the constants to the reference on this and other contacts.",
          "touchstone tune " + fast::shell_word(study.string()));
    } else {
      add("Tune the constants to the reference with touchstone tune and a study of this scene, as reports/tuning.md "
          "describes. meshes/studies/ball-on-cube.toml is an example.");
    }
  }

  [[nodiscard]] std::string again(const std::string& options) const { return command_text(call_, options); }

  [[nodiscard]] bool time_left() const { return watch_.wall_s() < trial_time_s; }

  const scene::Scene& scene_;
  const fast::Run& run_;
  const reference::Result& result_;
  const Errors& errors_;
  const Call& call_;
  scene::Stopwatch watch_;
  std::vector<NextStep> steps_;
};

}  // namespace

std::vector<NextStep> next_steps(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                 const Errors& errors, const Call& call) {
  if (call.scene_file.empty()) return {};
  return Finder(scene, run, result, errors, call).find();
}

}  // namespace touchstone::compare
