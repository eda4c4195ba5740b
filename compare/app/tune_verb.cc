#include "compare/app/tune_verb.h"

#include "compare/format/text.h"
#include "compare/tune/tune.h"
#include "compare/tune/tune_results.h"
#include "fast/command/progress_line.h"
#include "scene/output/results.h"

#include <fmt/format.h>

#include <iostream>

namespace touchstone::compare {
namespace {

std::string model_text(const Tuning& tuning, const TunedModel& model) {
  std::string text = model.name() + "\n";
  for (const StageFit& stage : model.stages) {
    for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
      text += fmt::format("  {} = {} {}\n", stage.parameters[k].key, number_text(stage.fit.parameters[k].value),
                          stage.parameters[k].unit);
    }
    for (const std::string& note : stage.notes) text += wrapped("  " + note) + "\n";
  }
  for (const bool held_out : {true, false}) {
    for (const TuningOutcome& outcome : model.outcomes) {
      const TuningData& data = tuning.data[outcome.data];
      if (data.held_out() != held_out) continue;
      text += fmt::format("  {:8}  force {:>7} of the peak, shape {:>7}   {}\n", held_out ? "held out" : "training",
                          quantity_text(outcome.errors.force_nrmse.value, "", "-"),
                          quantity_text(outcome.errors.shape_rel_l2.value, "", "-"), data.contact.name);
    }
  }
  for (const std::string& sentence : model.limits) text += wrapped(sentence) + "\n";
  return text + "\n";
}

int run(const TuneOptions& options, const ReferenceOptions& reference) {
  const TuningStudy study = load_tuning_study(
      options.study, [&](const scene::Scene& scene) { return reference::unsupported(asked(scene, reference)); });
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("out") / (study.name + "-tune") : options.out;
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  scene::Manifest manifest =
      scene::make_manifest(study.training.front().scene, "touchstone tune " + options.study.string());
  const scene::Stopwatch watch;
  const Tuning tuning = tune(
      study,
      [&](const scene::Scene& scene, const scene::Surface& surface) {
        return solve_with_progress(asked(scene, reference), surface, reference, options.quiet);
      },
      fast::progress_lines(options.quiet));
  manifest.times.push_back(watch.read("references, fits and errors"));
  for (const TuningData& data : tuning.data)
    manifest.entries.emplace_back("reference of " + data.contact.name, data.result.key);
  write_tuning(folder, tuning, manifest);
  for (const TunedModel& model : tuning.models) std::cout << model_text(tuning, model);
  for (const TuningData& data : tuning.data) {
    std::cout << data.contact.name << '\n' << refinement_text(data.result);
  }
  std::cout << "Parameters: " << (folder / "parameters.toml").string()
            << "\nReport: " << (folder / "report.html").string() << '\n';
  return fast::done;
}

}  // namespace

void add_tune_verb(fast::Command& program, TuneOptions& options, ReferenceOptions& reference) {
  fast::Command tune =
      program.add("tune", "fit the fast model's free constants on training contacts, judge them on held-out ones");
  tune.option("STUDY", options.study, "tuning study (TOML)").required();
  tune.option("--out", options.out, "result folder (default out/<study>-tune)");
  tune.flag("--quiet", options.quiet, "no progress");
  tune.action([&] { return run(options, reference); });
  tune.example("tune meshes/studies/ball-on-cube.toml");
  add_solve_options(tune, reference);
}

}  // namespace touchstone::compare
