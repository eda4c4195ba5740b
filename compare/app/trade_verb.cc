#include "compare/app/trade_verb.h"

#include "fast/command/progress_line.h"
#include "scene/output/results.h"

#include <iostream>

namespace touchstone::compare {
namespace {

int run(const fast::VerbOptions& options, const TradeOptions& trade_options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  refuse_unsupported(scene);
  const std::filesystem::path folder = options.folder(scene, "trade");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  scene::Manifest manifest = scene::make_manifest(scene, "touchstone trade");
  const scene::Stopwatch watch;
  std::string references;  // why the refinement of each reference ended
  const Trade found = trade(
      scene, trade_options,
      [&](const scene::Scene& contact, const scene::Surface& surface, std::optional<int> levels) {
        scene::Scene one = asked(contact, reference);
        if (levels) one.reference.levels = levels;
        reference::Result result = solve_with_progress(one, surface, reference, options.quiet);
        if (!levels) references += one.name + '\n' + refinement_text(result);
        return result;
      },
      fast::progress_lines(options.quiet));
  manifest.times.push_back(watch.read("trade"));
  if (!trade_options.held_out.empty()) manifest.entries.emplace_back("held out", trade_options.held_out.string());
  for (const auto& file : trade_options.parameters) manifest.entries.emplace_back("parameters", file.string());
  write_trade(folder, found, manifest);
  std::cout << trade_text(found) << references << "Report: " << (folder / "report.html").string() << '\n';
  return fast::done;
}

}  // namespace

void add_trade_verb(fast::Command& program, fast::VerbOptions& options, TradeOptions& trade,
                    ReferenceOptions& reference) {
  fast::Command verb =
      fast::add_verb_with_folder(program, "trade", "plot step time against error for every model and level",
                                 "meshes/scenes/ball-on-cube-press.toml --quick --out out/trade", options,
                                 [&] { return run(options, trade, reference); });
  verb.option("--parameters", trade.parameters, "file written by tune; its constants are one more row; may be repeated")
      .one_value_each_time();
  verb.option("--held-out", trade.held_out, "tuning study; the models are judged on its held-out contacts");
  verb.flag("--quick", trade.quick, "few steps and small sizes");
  add_solve_options(verb, reference);
}

}  // namespace touchstone::compare
