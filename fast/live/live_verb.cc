#include "fast/live/live_verb.h"

#include "fast/command/progress_line.h"
#include "fast/command/stop_signals.h"
#include "fast/run/run.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>

namespace touchstone::live {
namespace {

/// The command that repeats this run.
std::string command_line(const fast::VerbOptions& options, const LiveOptions& live, const std::string& command) {
  std::string text =
      fmt::format("{} {} --device {}", command, fast::shell_word(options.scene_file.string()), name_of(live.device));
  for (const std::string& setting : options.overrides) text += " --set " + fast::shell_word(setting);
  if (live.seconds) text += fmt::format(" --seconds {:g}", *live.seconds);
  if (live.rate_hz) text += fmt::format(" --rate {}", *live.rate_hz);
  if (!live.log.empty()) text += " --log " + fast::shell_word(live.log.string());
  if (live.scheduling.processor) text += fmt::format(" --processor {}", *live.scheduling.processor);
  return text;
}

}  // namespace

int live_verb(const fast::VerbOptions& options, const LiveOptions& live, const std::string& command,
              const WritePage& page) {
  scene::Scene scene = options.load();
  if (options.prepare) options.prepare(scene);
  const std::filesystem::path folder = options.folder(scene, "live");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  scene::Manifest manifest = scene::make_manifest(scene, command);
  manifest.entries.emplace_back("command_line", command_line(options, live, command));
  manifest.entries.emplace_back("device", name_of(live.device));
  if (!live.log.empty()) manifest.entries.emplace_back("log", live.log.string());

  const scene::Stopwatch watch;
  fast::ProgressLine progress(options.quiet);
  // Further signals have no effect: `timeout` and some shells send two.
  const fast::StopSignals signals(fast::StopSignals::Again::nothing);
  // On the heap: its histograms are too large for a small stack.
  const std::unique_ptr<const LiveResult> kept(new LiveResult(run_live(
      scene, live, folder, fast::StopSignals::asked(), [&](const std::string& text) { progress.show(text); },
      [](const std::string& warning) { std::cerr << "warning: " << warning << '\n'; })));
  const LiveResult& result = *kept;
  progress.finish();
  manifest.times.push_back(watch.read("live"));
  scene::write_summary(folder / "summary.json", figures(result, live));
  scene::write_manifest(folder / "manifest.json", manifest);
  const std::string left =
      page ? "Report: " + page(folder, scene, live, result, manifest).string() : "Results: " + folder.string();
  std::cout << summary_text(result) << left << '\n';
  if (result.interrupted) return fast::interrupted;
  return result.replay && !result.replay->equal() ? fast::answer_is_no : fast::done;
}

void add_live_verb(fast::Command& program, fast::VerbOptions& options, LiveOptions& live, const WritePage& page) {
  fast::Command verb =
      fast::add_verb_with_folder(program, "live", "run the fast model in real time, driven by a device",
                                 "meshes/scenes/ball-on-cube-press.toml --device hand --seconds 10", options,
                                 [&options, &live, name = program.program_name(), page] {
                                   return live_verb(options, live, name + " live", page);
                                 });
  verb.option(
          "--device",
          [&live](const std::string& name) -> std::string {
            std::vector<std::string> names;
            for (const DeviceKind kind : {DeviceKind::scripted, DeviceKind::replay, DeviceKind::hand}) {
              live.device = kind;
              if (name == name_of(kind)) return "";
              names.emplace_back(name_of(kind));
            }
            return "expected scripted, replay or hand, found \"" + name + '"' + scene::did_you_mean(name, names);
          },
          "scripted (default): the track; replay: a log; hand: a virtual hand on the track")
      .type("scripted|replay|hand");
  verb.option("--seconds", live.seconds, "length (default the track's or the log's; 10 for hand)");
  verb.option("--rate", live.rate_hz, "ticks per second, 1 to 10000 (default 1000, or the log's)");
  verb.option("--log", live.log, "replay: live.csv of an earlier run");
  verb.option("--processor", live.scheduling.processor, "processor for the loop's thread (default the last allowed)");
}

}  // namespace touchstone::live
