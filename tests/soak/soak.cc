// The soak test: many ticks in virtual time, with a device that moves at random over random scenes. See README.md.
#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"
#include "fast/command/stop_signals.h"
#include "fast/live/safety.h"
#include "fast/step/cell_rule.h"
#include "fast/step/step.h"
#include "soak/closed_path.h"
#include "soak/random_device.h"
#include "soak/random_scene.h"
#include "soak/watch.h"
#include "support/source_folder.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <tuple>

namespace {

using namespace touchstone;
using soak::PathKind;
using soak::Property;
using soak::Random;

constexpr bool sanitized = TOUCHSTONE_SANITIZED;

/// Largest growth of the resident memory within a scene, after a quarter of its ticks [bytes].
constexpr std::int64_t growth_in_scene = 256 * 1024;
/// Largest growth between scenes, with no model in memory, from the end of the first tenth to the end [bytes].
constexpr std::int64_t growth_between_scenes = 2 * 1024 * 1024;
/// Largest gain on a path of the class that must not gain, relative to the exchanged work.
constexpr double gain_tolerance = 1e-6;
/// Number of faults printed, per scene and in all; the rest are only counted.
constexpr int faults_told_of_scene = 3, faults_told = 100;

struct Options {
  double ticks = 1e5;
  std::uint64_t seed = 1;
  std::int64_t scene_ticks = 0;  ///< 0: follows from `ticks`
  int only_scene = -1;
  bool quiet = false;

  [[nodiscard]] std::int64_t per_scene() const {
    return scene_ticks > 0 ? scene_ticks
                           : std::clamp<std::int64_t>(static_cast<std::int64_t>(ticks / 1000), 2500, 100000);
  }
  [[nodiscard]] std::int64_t scenes() const {
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(ticks / static_cast<double>(per_scene())));
  }
};

/// Closed paths of one kind.
struct Gains {
  std::int64_t paths = 0, above_tolerance = 0, above_percent = 0;
  double worst_rel = -1.0, sum_rel = 0.0;  ///< the tool's gain over the exchanged work
};
/// Bounded, formulation, friction, kind, constant direction.
using GainKey = std::tuple<bool, scene::Formulation, bool, PathKind, bool>;

struct Run {
  Options options;
  soak::Figures figures;
  std::map<GainKey, Gains> gains;
  std::int64_t scenes = 0;
  double ratio_least = 1e300, ratio_most = 0.0;  ///< tool over body, largest extents
  std::int64_t resident_first = 0, resident_last = 0, resident_most = 0, growth_most = 0;  ///< [bytes]
  std::map<std::string, std::int64_t> faults;  ///< by the kind of fault: the words before the colon
  int told = 0;
};

double extent_m(const scene::Bounds& bounds) { return (bounds.upper_m - bounds.lower_m).maxCoeff(); }

void look_at_memory(Run& run, bool holds) {
  soak::Looked& looked = run.figures.looked[static_cast<std::size_t>(Property::memory)];
  ++looked.times;
  if (!sanitized && !holds) ++looked.faults;
}

void look_at_gain(Run& run, const scene::Scene& scene, PathKind kind, const soak::RoundWork& work,
                  const std::function<void(Property, const std::string&)>& report) {
  if (!(work.turned_over_j > 0.0)) return;
  const bool friction = scene.contact.friction.has_value();
  const bool steady = work.steady && (kind != PathKind::level || work.flat);
  const bool bounded =
      scene.fast.formulation == scene::Formulation::corrected && !friction && steady && kind != PathKind::loop;
  Gains& gains = run.gains[{bounded, scene.fast.formulation, friction, kind, steady}];
  const double gain_rel = work.gained_j / work.turned_over_j;
  ++gains.paths;
  gains.above_tolerance += gain_rel > gain_tolerance;
  gains.above_percent += gain_rel > 0.01;
  gains.worst_rel = std::max(gains.worst_rel, gain_rel);
  gains.sum_rel += gain_rel;
  if (!bounded) return;
  soak::Looked& looked = run.figures.looked[static_cast<std::size_t>(Property::energy)];
  ++looked.times;
  if (gain_rel <= gain_tolerance) return;
  ++looked.faults;
  report(Property::energy,
         fmt::format("a closed path gained energy: {:.3g} of the {:.3g} J exchanged", gain_rel, work.turned_over_j));
}

void run_scene(Run& run, int index, const soak::ToolMeshes& meshes, fast::ProgressLine& progress) {
  Random random(run.options.seed, static_cast<std::uint64_t>(index));
  const scene::Scene scene = soak::random_scene(index, meshes, random);
  const fast::FastModel model = fast::model_of(scene);
  fast::FastState state(model);
  const std::int64_t ticks = run.options.per_scene();
  std::int64_t tick = 0;
  int told = 0;
  const auto report = [&](Property, const std::string& what) {
    ++run.faults[what.substr(0, what.find(':'))];
    if (++told > faults_told_of_scene || ++run.told > faults_told) return;
    progress.finish();
    fmt::print(stderr, "fault: scene {}, tick {}: {} ({}); again with --seed {} --scene {} --scene-ticks {}\n", index,
               tick, what, soak::words_for(scene), run.options.seed, index, ticks);
  };
  soak::Watch watch(model, state, run.figures, report);
  const auto step = [&](const scene::Pose& pose) {
    watch.before_step();
    const fast::StepStatus status = fast::step(model, pose, state);
    watch.after_step(pose, status);
    ++tick;
    return status;
  };

  // A quarter of the ticks on closed paths, the others with the device.
  constexpr std::int64_t path_ticks = 2 * soak::ticks_per_round + 1;
  const std::int64_t paths = std::max<std::int64_t>(1, ticks / 4 / path_ticks);
  const std::int64_t device_ticks = ticks - paths * path_ticks - 1;
  soak::RandomDevice device(model, scene, device_ticks, random);
  const double period_s = 1.0 / scene.fast.rate_hz;
  live::WrenchLimiter limiter(live::WrenchLimits::of(scene.live, extent_m(model.body->bounds())), period_s);
  std::int64_t resident = 0;
  for (std::int64_t i = 0; i < device_ticks; ++i) {
    const live::Tick now{i, static_cast<double>(i) * period_s};
    live::DeviceSample sample;
    if (!device.read(now, sample)) continue;
    const bool good = step(sample.pose) != fast::StepStatus::not_finite;
    device.write(limiter.next({total_force_n(state), total_torque_nm(state)}, good));
    if (i == device_ticks / 4) resident = soak::resident_bytes();
  }
  for (std::int64_t i = 0; i < paths; ++i) {
    // Every kind in every scene; level ones twice as often.
    const auto kind = static_cast<PathKind>((index + i) % 4 % 3);
    const soak::ClosedPath path = soak::closed_path(kind, model, random);
    look_at_gain(run, scene, kind, soak::go_round(model, state, path, step), report);
  }
  // Far away until the end.
  step({scene::Vec3(0.0, 0.0, 1e4), Eigen::Quaterniond::Identity()});
  const std::int64_t growth = soak::resident_bytes() - resident;
  run.growth_most = std::max(run.growth_most, growth);
  look_at_memory(run, growth <= growth_in_scene);
  if (!sanitized && growth > growth_in_scene)
    report(Property::memory, fmt::format("more resident memory: {} KiB", growth / 1024));

  double tool_m = 0.0;
  for (int k = 0; k < model.tool.count(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    tool_m = std::max(tool_m, 2.0 * scene::Vec3(model.tool.x_T_m[i], model.tool.y_T_m[i], model.tool.z_T_m[i]).norm());
  }
  const double ratio = tool_m / extent_m(model.body->bounds());
  run.ratio_least = std::min(run.ratio_least, ratio);
  run.ratio_most = std::max(run.ratio_most, ratio);
  run.resident_most = std::max(run.resident_most, soak::resident_bytes());
  ++run.scenes;
}

std::string name_of(PathKind kind) {
  switch (kind) {
    case PathKind::level:
      return "level";
    case PathKind::there_and_back:
      return "there and back";
    case PathKind::loop:
      return "loop";
  }
  return "";
}

void print_tables(const Run& run, double seconds) {
  const soak::Figures& f = run.figures;
  const auto share = [&](std::int64_t count) {
    return fmt::format("{:.3g} %",
                       100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::int64_t>(1, f.ticks)));
  };
  fmt::print("| run | |\n|---|---|\n");
  fmt::print("| seed | {} |\n| scenes | {} |\n| ticks | {} |\n", run.options.seed, run.scenes, f.ticks);
  fmt::print("| time | {:.0f} s, {:.1f} us a tick with all checks |\n", seconds,
             1e6 * seconds / static_cast<double>(std::max<std::int64_t>(1, f.ticks)));
  fmt::print("| tool over body, largest extents | {:.2g} to {:.2g} |\n", run.ratio_least, run.ratio_most);
  fmt::print("| ticks in contact | {} |\n| with several regions | {} |\n| sliding | {} |\n", share(f.in_contact),
             share(f.several_regions), share(f.sliding));
  fmt::print("| contacts ended | {} |\n", f.contacts_ended);
  constexpr std::array bits{"not_finite", "depth_limited", "law_saturated", "anchors_limited", "regions_full"};
  for (std::size_t i = 0; i < bits.size(); ++i) fmt::print("| status {} | {} |\n", bits[i], share(f.bits[i]));
  constexpr double mib = 1024.0 * 1024.0;
  fmt::print("| resident memory between scenes | {:.2f} MiB at first, {:.2f} MiB at last |\n",
             static_cast<double>(run.resident_first) / mib, static_cast<double>(run.resident_last) / mib);
  fmt::print("| largest resident memory | {:.1f} MiB |\n", static_cast<double>(run.resident_most) / mib);
  fmt::print("| most growth within a scene | {} KiB |\n", run.growth_most / 1024);

  fmt::print("\n| property | looked at | faults | worst | bound |\n|---|---|---|---|---|\n");
  constexpr std::array<const char*, soak::properties> names{"force, torque and surface are finite",
                                                            "what is cut off has its status bit",
                                                            "a bad pose is named, and held",
                                                            "at rest without contact",
                                                            "memory constant",
                                                            "no energy from closed paths, see below"};
  double worst_gain = -1.0;
  for (const auto& [key, gains] : run.gains)
    if (std::get<0>(key)) worst_gain = std::max(worst_gain, gains.worst_rel);
  const std::array<std::string, soak::properties> worst{"",
                                                        "",
                                                        "",
                                                        fmt::format("{:.2g} m", f.farthest_from_rest_m),
                                                        fmt::format("{} KiB", run.growth_most / 1024),
                                                        fmt::format("{:.2g}", worst_gain)};
  const std::array<std::string, soak::properties> bound{
      "",
      "",
      "",
      fmt::format("{:.0e} m", soak::rest_tolerance_m),
      sanitized ? "none under sanitizers" : fmt::format("{} KiB", growth_in_scene / 1024),
      fmt::format("{:.0e}", gain_tolerance)};
  for (std::size_t i = 0; i < soak::properties; ++i) {
    fmt::print("| {} | {} | {} | {} | {} |\n", names[i], f.looked[i].times, f.looked[i].faults, worst[i], bound[i]);
  }

  if (!run.faults.empty()) fmt::print("\n| fault | times |\n|---|---|\n");
  for (const auto& [what, times] : run.faults) fmt::print("| {} | {} |\n", what, times);

  fmt::print(
      "\n| closed paths | friction | path | direction | gain | paths | above {:.0e} | above 1 % | largest | mean |\n",
      gain_tolerance);
  fmt::print("|---|---|---|---|---|---|---|---|---|---|\n");
  for (auto it = run.gains.rbegin(); it != run.gains.rend(); ++it) {
    const auto& [bounded, formulation, friction, kind, steady] = it->first;
    const Gains& g = it->second;
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {:.2g} | {:.2g} |\n",
               formulation == scene::Formulation::published ? "published" : "corrected", friction ? "yes" : "no",
               name_of(kind), steady ? "steady" : "any", bounded ? "bounded" : "measured", g.paths, g.above_tolerance,
               g.above_percent, g.worst_rel, g.sum_rel / static_cast<double>(g.paths));
  }
}

int soak_all(const Options& options) {
  Run run;
  run.options = options;
  const soak::ToolMeshes meshes = soak::tool_meshes(source_folder() + "/meshes/tools");
  const fast::StopSignals stop(fast::StopSignals::Again::end_at_once);
  fast::ProgressLine progress(options.quiet);
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  const std::int64_t scenes = options.scenes();
  std::int64_t index = std::max(0, options.only_scene);
  const std::int64_t end = options.only_scene >= 0 ? index + 1 : scenes;
  for (; index < end && !fast::StopSignals::asked(); ++index) {
    run_scene(run, static_cast<int>(index), meshes, progress);
    malloc_trim(0);
    run.resident_last = soak::resident_bytes();
    if (10 * (index + 1) <= end || run.resident_first == 0)
      run.resident_first = std::max(run.resident_first, run.resident_last);
    progress.show(fmt::format("soak: {:.1f} %, scene {} of {}, {} ticks, {} faults, {:.0f} s, {:.1f} MiB",
                              100.0 * static_cast<double>(index + 1) / static_cast<double>(end), index + 1, end,
                              run.figures.ticks, run.figures.faults(), seconds(),
                              static_cast<double>(run.resident_last) / (1024.0 * 1024.0)));
  }
  progress.finish();
  look_at_memory(run, run.resident_last - run.resident_first <= growth_between_scenes);
  print_tables(run, seconds());
  if (fast::StopSignals::asked()) return fast::interrupted;
  // A property that was never checked has not been shown.
  const auto& looked = run.figures.looked;
  const bool all_looked_at =
      options.only_scene >= 0 ||
      std::all_of(looked.begin(), looked.end(), [](const soak::Looked& property) { return property.times > 0; });
  return run.figures.faults() > 0 || !all_looked_at ? fast::answer_is_no : fast::done;
}

}  // namespace

int main(int argc, char** argv) {
  return fast::guarded([&] {
    fast::Program program(
        "Many ticks of the fast model in virtual time, random device over random scenes; exit 1 at a fault.",
        "soak_run");
    Options options;
    program.option("--ticks", options.ticks, "of the whole run, such as 1e8").shows_default().range(1e3, 1e11);
    program.option("--seed", options.seed, "equal seeds give equal runs").shows_default();
    program.option("--scene", options.only_scene, "this one alone, to look at a fault").range(0, 1 << 30);
    program
        .option("--scene-ticks", options.scene_ticks,
                "of each scene; a thousandth of all, 2500 to 100000, if not given")
        .range(1000, 1 << 30);
    program.flag("--quiet", options.quiet, "no progress");
    program.action([&options] { return soak_all(options); });
    return program.run(argc, argv);
  });
}
