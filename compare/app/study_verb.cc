#include "compare/app/study_verb.h"

#include "compare/app/verbs.h"
#include "compare/input/study_file.h"
#include "compare/study/study_run.h"
#include "compare/study/study_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

namespace touchstone::compare {
namespace {

/// Prints only a few warnings: usually all cases of an axis have the same fault.
void warn_of_no_contact(const StudyManifest& manifest) {
  constexpr std::size_t told_max = 3;
  std::vector<const ManifestCase*> without;
  for (const ManifestCase& one : manifest.cases) {
    if (!one.warning.empty()) without.push_back(&one);
  }
  for (std::size_t i = 0; i < std::min(told_max, without.size()); ++i) {
    std::cerr << fmt::format("warning: case {} ({}): {}\n", without[i]->index, without[i]->name, without[i]->warning);
  }
  if (without.size() > told_max) {
    std::cerr << fmt::format("warning: {} of {} cases are without contact\n", without.size(), manifest.cases.size());
  }
}

int expand_verb(const StudyOptions& options) {
  const Study study = load_study(options.study);
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("out") / (study.name + "-study") : options.out;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const StudyManifest manifest = expand(study, folder, program, options.reference.store);
  const std::size_t count = manifest.cases.size();
  warn_of_no_contact(manifest);
  const auto done = std::count_if(manifest.cases.begin(), manifest.cases.end(), [&](const ManifestCase& one) {
    return case_status(manifest, one).state == CaseState::done;
  });
  std::cout << fmt::format("{} cases in {}", count, (folder / "manifest.json").string());
  if (count < study.cases.size()) std::cout << fmt::format(", {} equal ones omitted", study.cases.size() - count);
  if (done > 0) std::cout << fmt::format(", {} already done", done);
  const std::string run =
      program.string() + " study run " + folder.string() + " --store " + options.reference.store.string();
  std::cout << fmt::format(
      "\n\nOne after the other, or this in several windows:\n  {0}\nGNU parallel, two at a time:\n  seq {1} | "
      "OMP_NUM_THREADS=1 parallel -j 2 {0} --quiet --index {{}}\nSlurm, once you have read and edited it:\n  sbatch "
      "{2}\nThen:\n  {3} study collect {4}\n",
      run, count, (folder / "array.sbatch").string(), program.string(), folder.string());
  return fast::done;
}

int run_verb(const StudyOptions& options) {
  const StudyManifest manifest = read_manifest(options.study);
  const auto run = [&](const std::filesystem::path& scene_file, const std::filesystem::path& folder) {
    const fast::VerbOptions verb{.scene_file = scene_file, .out = folder, .overrides = {}, .quiet = options.quiet};
    if (manifest.run == "fast") return run_fast(verb, options.reference);
    if (manifest.run == "reference") return run_reference(verb, options.reference);
    return run_compare(verb, options.reference);
  };
  const int count = static_cast<int>(manifest.cases.size());
  const CaseRange range =
      options.index == 0 ? CaseRange{} : CaseRange{options.index, options.step ? options.step : count};
  return run_cases(manifest, range, run, [](const std::string& line) { std::cout << line << std::endl; });
}

int collect_verb(const StudyOptions& options) {
  const StudyManifest manifest = read_manifest(options.study);
  const StudyTable table = collect(manifest);
  std::cout << table.text
            << fmt::format("{} of {} cases are done. Table: {}\nReport: {}\n", table.done, table.cases,
                           (manifest.folder / "summary.csv").string(), (manifest.folder / "report.html").string());
  return table.done == table.cases ? fast::done : fast::answer_is_no;
}

}  // namespace

void add_study_verb(fast::Command& program, StudyOptions& options) {
  fast::Command study =
      program.add("study", "run many cases of one scene: in a loop, with GNU parallel or on a batch system");
  const auto add = [&](const char* name, const char* what, const char* argument, const char* meaning, auto action) {
    fast::Command verb = study.add(name, what);
    verb.option(argument, options.study, meaning).required();
    verb.action([&options, action] { return action(options); });
    return verb;
  };
  fast::Command expand =
      add("expand", "write a folder of independent cases", "STUDY", "study file (TOML)", expand_verb);
  expand.option("--out", options.out, "the study's folder (default out/<study>-study)");
  add_store_option(expand, options.reference);
  expand.example("study expand meshes/studies/ball-on-cube-depth-and-place.toml --out out/depth-and-place");

  fast::Command run = add("run", "run the remaining cases of a study; several processes may run at a time", "DIR",
                          "the study's folder", run_verb);
  const fast::Option index =
      run.option("--index", options.index, "only this case, from 1").range(1, static_cast<int>(study_cases_max));
  run.option("--step", options.step, "and every case in steps of this after it, for long studies in short arrays")
      .range(1, static_cast<int>(study_cases_max))
      .needs(index);
  add_store_option(run, options.reference);
  run.flag("--quiet", options.quiet, "no progress of the cases' solvers");
  run.example("study run out/depth-and-place --index 3");

  fast::Command collect =
      add("collect", "table and report over all cases; exit 1 if some are not done, with the reasons", "DIR",
          "the study's folder", collect_verb);
  collect.example("study collect out/depth-and-place");
}

}  // namespace touchstone::compare
