#include "fast/bench/bench_verb.h"

#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"
#include "scene/output/results.h"

#include <fmt/format.h>

#include <cstdlib>
#include <iostream>

namespace touchstone::bench {
namespace {

/// Load average of the last minute, for the manifest.
std::string load_average() {
  double load = 0.0;
  if (getloadavg(&load, 1) != 1) return "unknown";
  return fmt::format("{:.2f}", load);
}

}  // namespace

int bench_verb(const BenchVerbOptions& options, const std::string& command) {
  const scene::FolderLock lock = scene::prepare_result_folder(options.out);
  scene::Manifest manifest = scene::make_manifest(scene_of({scene::BodyShape::box, "4k", 1}), command);
  manifest.entries.emplace_back("only", options.only.empty() ? "everything" : options.only);
  manifest.entries.emplace_back("effort", options.quick ? "quick" : "full");
  manifest.entries.emplace_back("load_average_before", load_average());
  const scene::Stopwatch watch;
  fast::ProgressLine progress(options.quiet);
  const BenchResult result = run_bench(options, [&](const std::string& text) { progress.show(text, true); });
  progress.finish();
  manifest.times.push_back(watch.read("bench"));
  manifest.entries.emplace_back("load_average_after", load_average());
  manifest.entries.emplace_back("counters", result.counters);
  manifest.entries.emplace_back("peer", result.peer_version.empty() ? "none in this build" : result.peer_version);
  scene::write_summary(options.out / "summary.json", figures(result));
  scene::write_manifest(options.out / "manifest.json", manifest);
  std::cout << report_text(result) << "Results: " << options.out.string() << '\n';
  return fast::done;
}

void add_bench_verb(fast::Command& program, BenchVerbOptions& options) {
  fast::Command verb =
      program.add("bench", "time of a tick, per stage, compared with copying its output and with Bullet");
  verb.flag("--quick", options.quick, "about 10 s instead of more than a minute: fewer cases and ticks");
  verb.option("--only", options.only, "some cases: the first parts of a name such as box/4k/1, * for any part");
  verb.option("--ticks", options.ticks, "measured per case (default: by the time available)").range(1, 10000000);
  verb.option("--out", options.out, "result folder (default out/bench)");
  verb.flag("--quiet", options.quiet, "no progress, only results and errors");
  verb.example("bench --only box/4k");
  verb.action([&options, name = program.program_name()] { return bench_verb(options, name + " bench"); });
}

}  // namespace touchstone::bench
