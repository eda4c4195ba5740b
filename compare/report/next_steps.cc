#include "compare/report/next_steps.h"

#include "compare/errors/measure.h"
#include "compare/format/text.h"
#include "compare/input/tuning_study.h"
#include "compare/report/comparison_drawings.h"
#include "compare/report/model_table.h"
#include "fast/command/command_line.h"
#include "fast/step/state.h"
#include "scene/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace touchstone::compare {
namespace {

/// No further trials after this total time [s].
constexpr double trial_time_s = 5.0;

using Constants = std::vector<const scene::Field<scene::Scene>*>;

bool has(std::uint32_t status, fast::StepStatus bit) { return (status & static_cast<std::uint32_t>(bit)) != 0; }

/// Two significant digits, as a user would type them.
std::string typed(double value) { return fmt::format("{:.2g}", value); }

/// A tuning study that trains on this scene and fits one of these constants, from its folder or the folder "studies"
/// beside that.
std::filesystem::path tuning_study_of(const std::filesystem::path& scene_file, const Constants& constants) {
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
        const bool fits = std::ranges::any_of(study.parameters, [&](const TuningParameter& one) {
          return std::ranges::count(constants, scene::tunable_field(one.key)) != 0;
        });
        if (trains && fits) return file;
      } catch (const scene::InputError&) {
        continue;  // an unfinished file in the same folder
      }
    }
  }
  return {};
}

class Finder final : Advice {
 public:
  Finder(const scene::Scene& scene, const fast::Run& run, const reference::Result& result, const Errors& errors,
         const Call& call, const ModelEntry& model)
      : scene_(scene), run_(run), result_(result), errors_(errors), call_(call), model_(model) {}

  std::vector<NextStep> find() {
    if (errors_.force_peak_reference_n == 0.0) {
      nearer();
      return std::move(steps_);
    }
    less_deep();
    more_regions();
    known_better();
    if (model_.account.advise) model_.account.advise(*this);
    return std::move(steps_);
  }

 private:
  [[nodiscard]] const scene::Scene& scene() const override { return scene_; }
  [[nodiscard]] const Errors& errors() const override { return errors_; }
  [[nodiscard]] std::uint32_t status() const override { return run_.status; }
  [[nodiscard]] bool time_left() const override { return watch_.wall_s() < trial_time_s; }

  [[nodiscard]] Trial tried(const scene::Scene& changed) const override {
    const fast::Run run = model_.set_up(changed)->track().value();
    MeanSquares force;
    SquareSums shape;
    for (std::size_t t = 0; t < run.instants.size(); ++t) {
      const scene::InstantRecord &f = run.instants[t], &r = result_.instants[t];
      force.add((f.force_n() - r.force_n()).norm(), 0.0);
      for (Eigen::Index i = 0; i < f.displacement_m.cols(); ++i) {
        shape.add(run.surface.vertex_area_m2[static_cast<std::size_t>(i)],
                  (f.displacement_m.col(i) - r.displacement_m.col(i)).norm(), 0.0, r.displacement_m.col(i).norm());
      }
    }
    const double infinite = std::numeric_limits<double>::infinity();
    return {force.over(errors_.force_peak_reference_n).value.value_or(infinite),
            shape.relative().value.value_or(infinite), run.status};
  }

  void again(const std::string& why, const std::string& options) override { add(why, command_text(call_, options)); }

  void with_parameters(const std::string& why, const std::string& name, const std::string& text) override {
    const std::string file = name + ".toml";
    Call call = call_;
    call.compare.parameters = call_.folder / file;
    steps_.push_back(
        {why, command_text(call, " --out " + fast::shell_word(call_.folder.string() + "-" + name)), file, text});
  }

  void tune(const std::string& example, const std::string& tried) override {
    const auto matters = [](const Measure& error) {
      return error.value.value_or(0.0) > small_error && error.distinguishable();
    };
    if (!call_.compare.parameters.empty() || (!matters(errors_.force_nrmse) && !matters(errors_.shape_rel_l2))) return;
    Constants constants = scene::tunable_fields(scene_);
    std::erase_if(constants, [](const auto* field) { return field->tunable->stage == TuningStage::model; });
    const std::string what = constants.size() == 1 ? std::string(constants.front()->key) : "the constants";
    if (const std::filesystem::path study = tuning_study_of(call_.scene_file, constants); !study.empty()) {
      add("Tune " + what + " to the reference on this and other contacts." + tried,
          "touchstone tune " + fast::shell_word(study.string()));
    } else {
      add("Tune " + what +
          " to the reference with touchstone tune and a study of this scene, as reports/tuning.md "
          "describes. " +
          example + " is an example." + tried);
    }
  }

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
    again("Allow more contact regions.",
          fmt::format(" --set fast.max_regions={}", std::min(64, 2 * scene_.fast.max_regions)));
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

  const scene::Scene& scene_;
  const fast::Run& run_;
  const reference::Result& result_;
  const Errors& errors_;
  const Call& call_;
  const ModelEntry& model_;
  scene::Stopwatch watch_;
  std::vector<NextStep> steps_;
};

}  // namespace

std::vector<NextStep> next_steps(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                 const Errors& errors, const Call& call, const ModelEntry& model) {
  if (call.scene_file.empty()) return {};
  return Finder(scene, run, result, errors, call, model).find();
}

}  // namespace touchstone::compare
