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
#include "compare/model/registry.h"
#include "compare/report/live_report.h"
#include "compare/solve/reference_run.h"
#include "fast/app/completion.h"
#include "fast/app/new_verb.h"
#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"
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
  fast::Program program("Measures real-time contact models against a finite-strain reference with known uncertainty.",
                        "touchstone");
  program.prints("--scene-reference", scene::scene_reference_markdown,
                 "print every key of a scene file as a Markdown table");

  fast::VerbOptions options;
  live::LiveOptions live_options;
  compare::ReferenceOptions reference;
  compare::VerifyOptions verify_options;
  fast::NewOptions new_options;
  fast::add_new_verb(program, new_options);
  compare::CompareOptions compare_options;
  compare::add_scene_verbs(program, options, reference, compare_options);
  compare::add_prepare_verb(program, options, reference);
  compare::StudyOptions study_options;
  compare::add_study_verb(program, study_options);
  compare::ResultsOptions results_options;
  compare::add_report_verb(program, results_options);
  compare::ViewOptions view_options;
  compare::add_view_verb(program, view_options);
  compare::TuneOptions tune_options;
  compare::add_tune_verb(program, tune_options, reference);
  compare::TradeOptions trade_options;
  compare::add_trade_verb(program, options, trade_options, reference);
  compare::ExportOptions export_options;
  compare::add_export_verb(program, options, export_options, reference);
  options.prepare = [&](scene::Scene& scene) {
    scene = compare::asked(scene, reference);
    compare::prepare_missing(scene, fast::progress_lines(false));
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
      "touchstone COMMAND --help: its options and an example.\n"
      "Exit status: 0 done, 1 a check failed, 2 bad input, 3 not converged.");
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
    // Any command may have to compute a body's response.
    return compare::with_reference_exits([&] { return run_program(argc, argv); });
  });
}
