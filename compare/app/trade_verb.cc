#include "compare/app/trade_verb.h"

#include "scene/output/results.h"

#include <iostream>

namespace touchstone::compare {
namespace {

int run(const fast::VerbOptions& options, const TradeOptions& trade_options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  if (std::vector<scene::Fault> faults = reference::unsupported(scene); !faults.empty()) {
    throw scene::InputError(std::move(faults));
  }
  const std::filesystem::path folder = options.folder(scene, "trade");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  return with_reference_exits([&] {
    scene::Manifest manifest = scene::make_manifest(scene, "touchstone trade");
    const scene::Stopwatch watch;
    std::string references;  // why the refinement of each reference ended
    TradeOptions with_store = trade_options;
    with_store.store = reference.store;
    const Trade found = trade(
        scene, with_store,
        [&](const scene::Scene& contact, const scene::Surface& surface, std::optional<int> levels) {
          scene::Scene one = asked(contact, reference);
          if (levels) one.reference.levels = levels;
          reference::Result result = solve_with_progress(one, surface, reference, options.quiet);
          if (!levels) references += one.name + '\n' + refinement_text(result);
          return result;
        },
        [&](const std::string& line) {
          if (!options.quiet) std::cerr << line << '\n';
        });
    manifest.times.push_back(watch.read("trade"));
    if (!trade_options.held_out.empty()) manifest.entries.emplace_back("held out", trade_options.held_out.string());
    for (const auto& file : trade_options.parameters) manifest.entries.emplace_back("parameters", file.string());
    write_trade(folder, found, manifest);
    std::cout << trade_text(found) << references << "Report: " << (folder / "report.html").string() << '\n';
    return fast::done;
  });
}

}  // namespace

fast::Command add_trade_verb(fast::Command& program, fast::VerbOptions& options, TradeOptions& trade,
                             ReferenceOptions& reference) {
  fast::Command verb = fast::add_verb(program, "trade", "step time and errors of every model and level, on one plot",
                                      "meshes/scenes/ball-on-cube-press.toml --quick --out out/trade", options,
                                      [&] { return run(options, trade, reference); });
  verb.option("--parameters", trade.parameters, "file written by tune, adds a row with its values; may be repeated")
      .one_value_each_time();
  verb.option("--held-out", trade.held_out, "tuning study by whose held-out contacts the models are judged");
  verb.flag("--quick", trade.quick, "few steps and small sizes");
  return verb;
}

}  // namespace touchstone::compare
