// touchstone: from a scene file to a result folder.
#include "compare/app/export_verb.h"
#include "compare/app/gate_verb.h"
#include "compare/app/prepare_verb.h"
#include "compare/app/results_verb.h"
#include "compare/app/study_verb.h"
#include "compare/app/trade_verb.h"
#include "compare/app/tune_verb.h"
#include "compare/app/verbs.h"
#include "compare/app/verify_verb.h"
#include "compare/app/view_verb.h"
#include "compare/model/engine_model.h"
#include "compare/report/live_report.h"
#include "fast/app/completion.h"
#include "fast/app/new_verb.h"
#include "fast/command/command_line.h"
#include "fast/live/live_verb.h"
#include "reference/contact/contact_ranks.h"
#include "reference/linear/blas.h"
#include "reference/linear/ranks.h"
#include "scene/input/fields.h"

#include <cstdlib>
#include <iostream>

using namespace touchstone;

namespace {

int run_program(int argc, char** argv) {
  const reference::ranks::Session session;
  if (!reference::ranks::first()) {
    reference::follow_first_rank();
    return fast::done;
  }
  fast::Program program("Errors of a fast contact model against a finite-strain reference with known uncertainty.",
                        "touchstone");
  program.prints("--scene-reference", scene::scene_reference_markdown,
                 "print every key of a scene file as a Markdown table");

  fast::VerbOptions options;
  live::LiveOptions live_options;
  compare::ReferenceOptions reference;
  compare::VerifyOptions verify_options;
  fast::NewOptions new_options;
  fast::add_new_verb(program, new_options);
  const auto add = [&](const char* name, const char* what, const char* example, auto verb) {
    return fast::add_verb(program, name, what, example, options, [&, verb] { return verb(options, reference); });
  };
  const auto add_with_folder = [&](const char* name, const char* what, const char* example, auto verb) {
    fast::Command command = add(name, what, example, verb);
    command.option("--out", options.out, std::string("result folder (default out/<scene>-") + name + ")");
    return command;
  };
  const auto add_store = [&](fast::Command command) {
    command.option("--store", reference.store, "content-addressed reference results, shared by all runs")
        .shows_default();
  };
  const auto add_reference = [&](fast::Command command) {
    add_store(command);
    const fast::Option levels =
        command.option("--level", reference.levels, "number of meshes, in place of an error").range(1, 9);
    command
        .option("--error", reference.error,
                "refine until the uncertainty of force and shape is at most this, relative (default: the scene's)")
        .range(1e-4, 0.5)
        .excludes(levels);
    command
        .option("--memory-gib", reference.memory_gib,
                "skip a mesh that is estimated to need more (default 80 % of the memory)")
        .range(0.1, 1e6);
    command
        .option("--minutes", reference.minutes,
                "end a reference solve after this time, finished steps are kept (default 60; none with --level)")
        .range(0.01, 1e6);
  };
  const auto add_volume = [&](fast::Command command) {
    command.flag("--volume", reference.volume,
                 "also stress, pressure, J - 1 and displacement inside the reference's body: volume.pvd for ParaView");
  };
  const auto add_require_error = [&](fast::Command command) {
    command
        .option(
            "--require-error", reference.require_error,
            "exit 3 unless the uncertainty of force and shape is at most this, relative; results are written anyway")
        .range(1e-4, 0.5);
  };
  add_store(add("plan", "what each solver models of a scene, what it leaves out and why",
                "meshes/scenes/ball-on-cube-press.toml --set fast.formulation=published", compare::plan));
  add_store(add_with_folder("fast", "the real-time model over the scene's track in virtual time",
                            "meshes/scenes/ball-on-cube-press.toml --out out/press", compare::run_fast));
  fast::Command solved =
      add_with_folder("reference", "the offline solve; uses stored results, resumes where it was interrupted",
                      "meshes/scenes/hertz-sphere.toml --error 0.005", compare::run_reference);
  add_reference(solved);
  add_require_error(solved);
  add_volume(solved);
  compare::CompareOptions compare_options;
  fast::Command compared = add_with_folder(
      "compare", "both solvers, then force and shape errors: tables, VTK, report",
      "meshes/scenes/ball-on-cube-press.toml --set tool.radius_m=0.008 --error 0.02",
      [&](const auto& given, const auto& asked) { return compare::run_compare(given, asked, compare_options); });
  compared.option("--parameters", compare_options.parameters, "file written by tune, for the fast model alone");
  compared
      .option("--model", compare_options.models,
              "another model for the table, by its key in a trade, such as compliance-1; may be repeated")
      .one_value_each_time();
  compared.flag("--plots", compare_options.plots,
                "every plot of the report also as SVG and PDF, in the folder's plots/");
  add_reference(compared);
  add_require_error(compared);
  add_volume(compared);
  add_store(compare::add_prepare_verb(program, options, reference));
  compare::StudyOptions study_options;
  compare::add_study_verb(program, study_options);
  compare::ResultsOptions results_options;
  compare::add_report_verb(program, results_options);
  compare::ViewOptions view_options;
  compare::add_view_verb(program, view_options);
  compare::TuneOptions tune_options;
  add_reference(compare::add_tune_verb(program, tune_options, reference));
  compare::TradeOptions trade_options;
  fast::Command trade_verb = compare::add_trade_verb(program, options, trade_options, reference);
  trade_verb.option("--out", options.out, "result folder (default out/<scene>-trade)");
  add_reference(trade_verb);
  compare::ExportOptions export_options;
  fast::Command export_verb = compare::add_export_verb(program, options, export_options, reference);
  export_verb.option("--out", options.out, "result folder (default out/<scene>-export)");
  add_store(export_verb);
  options.prepare = [&](scene::Scene& scene) {
    scene = compare::asked(scene, reference);
    compare::prepare_missing(scene, [](const std::string& line) { std::cerr << line << '\n'; });
  };
  live::add_live_verb(program, options, live_options, compare::write_live_report);
  compare::add_verify_verb(program, verify_options);
  compare::GateOptions gate_options;
  compare::add_gate_verb(program, gate_options);
  std::string shell;
  fast::add_completion_verb(program, shell);
  program.group({{"First", {"new", "plan", "compare"}},
                 {"One scene", {"fast", "live", "reference", "prepare", "trade", "export"}},
                 {"Results", {"view", "report"}},
                 {"Many scenes", {"study", "tune"}},
                 {"Checks", {"gate", "verify"}}});
  program.footer(
      "First steps:\n"
      "  touchstone new block.toml --body box 60x60x40mm --youngs-modulus 3MPa --poissons-ratio 0.45 \\\n"
      "    --tool sphere 10mm --depth 3mm\n"
      "  touchstone compare block.toml\n"
      "touchstone COMMAND --help: its options and an example. Exit status: 0 done, 1 a check failed, 2 bad input, 3 "
      "not\n"
      "converged.");
  return program.run(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return fast::guarded([&] {
    if (!reference::blas_has_memory()) {
      std::cerr << "not enough memory for the threads of the linear algebra; expected more memory, or fewer threads "
                   "with OPENBLAS_NUM_THREADS\n";
      // OpenBLAS threads may wait for memory for ever, and an ordinary exit waits for these threads.
      std::_Exit(fast::not_converged);
    }
    return run_program(argc, argv);
  });
}
