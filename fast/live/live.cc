#include "fast/live/live.h"

#include "fast/live/hand_device.h"
#include "fast/live/live_log.h"
#include "fast/live/replay_device.h"
#include "fast/live/scripted_device.h"
#include "fast/run/make_engine.h"
#include "scene/base/error.h"
#include "scene/base/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <thread>

namespace touchstone::live {
namespace {

using std::chrono::milliseconds;

constexpr int default_rate_hz = 1000, rate_max_hz = 10000;
constexpr double hand_default_s = 10.0, seconds_max = 7 * 86400.0;

/// The device and the settings of the loop that it needs.
struct Setup {
  LoopTime time;
  std::unique_ptr<Device> device;
  ReplayDevice* replay = nullptr;  ///< the device, if it is a replay
  std::int64_t replay_rows = 0;
};

std::int64_t points_in(double seconds, int rate_hz) { return std::llround(seconds * rate_hz); }

Setup set_up(const scene::Scene& scene, const LiveOptions& options) {
  if (options.seconds && !(*options.seconds > 0.0 && *options.seconds <= seconds_max)) {
    throw scene::InputError("--seconds = " + std::to_string(*options.seconds) + "; expected a number in (0, 604800]");
  }
  if (options.rate_hz && (*options.rate_hz < 1 || *options.rate_hz > rate_max_hz)) {
    throw scene::InputError("--rate = " + std::to_string(*options.rate_hz) + "; expected a whole number in [1, 10000]");
  }
  if (options.log.empty() != (options.device != DeviceKind::replay)) {
    throw scene::InputError(options.log.empty() ? "--device replay needs --log FILE; expected a live.csv"
                                                : "--log is for --device replay; expected no log");
  }
  Setup setup;
  setup.time.rate_hz = options.rate_hz.value_or(default_rate_hz);
  switch (options.device) {
    case DeviceKind::scripted: {
      const double length_s = scene.track.back().time_s - scene.track.front().time_s;
      // The end of the track is included.
      setup.time.grid_points = options.seconds ? points_in(*options.seconds, setup.time.rate_hz)
                                               : points_in(length_s, setup.time.rate_hz) + 1;
      setup.device = std::make_unique<ScriptedDevice>(scene.track, setup.time.period_s());
      break;
    }
    case DeviceKind::hand:
      setup.time.grid_points = points_in(options.seconds.value_or(hand_default_s), setup.time.rate_hz);
      setup.device = std::make_unique<HandDevice>(scene.track, scene.live, setup.time.period_s());
      break;
    case DeviceKind::replay: {
      LiveLog log = read_log(options.log);
      if (options.rate_hz && log.rate_hz != 0 && *options.rate_hz != log.rate_hz) {
        throw scene::InputError("--rate = " + std::to_string(*options.rate_hz) + "; expected " +
                                std::to_string(log.rate_hz) + ", the rate of " + options.log.string());
      }
      if (log.rate_hz != 0) setup.time.rate_hz = log.rate_hz;
      setup.replay_rows = static_cast<std::int64_t>(log.ticks.size());
      if (options.seconds) {
        setup.replay_rows = std::min(setup.replay_rows, points_in(*options.seconds, setup.time.rate_hz));
      }
      // Every row is replayed, however many grid points that takes.
      setup.time.grid_points = std::numeric_limits<std::int64_t>::max() / (2 * setup.time.rate_hz);
      setup.time.ticks = setup.replay_rows;
      auto device = std::make_unique<ReplayDevice>(std::move(log.ticks));
      setup.replay = device.get();
      setup.device = std::move(device);
      break;
    }
  }
  setup.time.grid_points = std::max<std::int64_t>(setup.time.grid_points, 1);
  return setup;
}

/// Writes the records to the file as they come and keeps their history. The file gets its final name only when
/// complete.
class Recorder {
 public:
  explicit Recorder(const std::filesystem::path& file) : file_(file) { file_.append(log_header()); }
  void drain(RecordRing<TickRecord>& ring, RunHistory& history) {
    text_.clear();
    for (TickRecord record; ring.pop(record);) {
      append_log_line(record, text_);
      history.add(record);
    }
    if (!file_.append(text_)) good_.store(false, std::memory_order_relaxed);
  }
  /// May be called from any thread.
  [[nodiscard]] bool good() const noexcept { return good_.load(std::memory_order_relaxed); }
  /// @throws std::filesystem::filesystem_error with the reason, such as a full disk
  void finish() {
    if (!file_.finish()) throw scene::InputError("live.csv: the file was removed while it was being written");
  }

 private:
  scene::UnfinishedFile file_;
  std::string text_;
  std::atomic<bool> good_{true};
};

/// Reads shapes as a viewer would: takes the newest shape at its own rate and reads all of it.
void read_shapes(const std::stop_token& stop, TripleBuffer<ShapeFrame>& shapes, LiveResult& result) {
  WallClock clock(0);
  while (!stop.stop_requested()) {
    const bool fresh = shapes.take();
    const ShapeFrame& frame = shapes.front();
    if (frame.tick >= 0) result.shape_age.add(clock.now_ns() - frame.stamp_ns);
    if (fresh) {
      ++result.shapes_read;
      const fast::Columns3& u_m = frame.field.displacement_m;
      float largest_m2 = 0.0f;
      for (std::size_t i = 0; i < u_m[0].size(); ++i) {
        largest_m2 = std::max(largest_m2, u_m[0][i] * u_m[0][i] + u_m[1][i] * u_m[1][i] + u_m[2][i] * u_m[2][i]);
      }
      result.displacement_max_m = std::max(result.displacement_max_m, std::sqrt(static_cast<double>(largest_m2)));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(16667));
  }
}

std::string progress_text(const LoopProgress& progress, const LoopTime& time) {
  const std::int64_t ticks = progress.ticks.load(std::memory_order_relaxed);
  const std::int64_t missed = progress.missed.load(std::memory_order_relaxed);
  return fmt::format("live: {:.1f} s, {} ticks, {} missed, force {:.3g} N", time.time_s(ticks + missed), ticks, missed,
                     progress.force_n.load(std::memory_order_relaxed));
}

}  // namespace

std::string name_of(DeviceKind device) {
  switch (device) {
    case DeviceKind::scripted:
      return "scripted";
    case DeviceKind::replay:
      return "replay";
    case DeviceKind::hand:
      return "hand";
  }
  return "unknown";
}

LiveResult run_live(const scene::Scene& scene, const LiveOptions& options, const std::filesystem::path& folder,
                    const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell,
                    const std::function<void(const std::string&)>& warn) {
  Setup setup = set_up(scene, options);
  const std::unique_ptr<fast::Engine> made = fast::make_engine(scene);
  fast::Engine& engine = *made;
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), setup.time.period_s());
  TripleBuffer<ShapeFrame> shapes(ShapeFrame{-1, 0, engine.field()});
  RecordRing<TickRecord> ring(options.ring_records);
  Recorder recorder(folder / "live.csv");
  // Spin for less than half of the period, or the kernel's real-time limit stops the thread.
  WallClock clock(std::min<std::int64_t>(150'000, setup.time.time_ns(1) / 2));
  LoopProgress progress;
  std::atomic<bool> stop_loop{false}, scheduled{false}, ended{false};

  LiveResult result;
  result.rate_hz = setup.time.rate_hz;
  give_threads_small_stacks();
  result.planned_s = setup.time.time_s(setup.replay != nullptr ? setup.replay_rows : setup.time.grid_points);
  {
    // All threads are stopped and joined at the end, also after an exception; the recorder last.
    std::jthread recorder_thread([&](const std::stop_token& end) {
      block_signals();
      while (!end.stop_requested()) {
        recorder.drain(ring, result.history);
        std::this_thread::sleep_for(milliseconds(5));
      }
      recorder.drain(ring, result.history);
    });
    std::jthread reader_thread([&](const std::stop_token& end) {
      block_signals();
      read_shapes(end, shapes, result);
    });
    std::jthread loop_thread([&](const std::stop_token& end) {
      const std::stop_callback forward(end, [&] { stop_loop.store(true, std::memory_order_relaxed); });
      block_signals();
      result.scheduling = schedule_this_thread(options.scheduling);
      scheduled.store(true, std::memory_order_release);
      run_device_loop(setup.time,
                      {*setup.device, engine, limiter, clock, &shapes, &ring, setup.replay, &progress, &stop_loop},
                      result.ledger);
      ended.store(true, std::memory_order_release);
    });
    while (!scheduled.load(std::memory_order_acquire)) std::this_thread::sleep_for(milliseconds(1));
    if (warn) {
      for (const std::string& warning : result.scheduling.warnings) warn(warning);
    }
    while (!ended.load(std::memory_order_acquire)) {
      if (stop.load(std::memory_order_relaxed)) {
        result.interrupted = true;
        stop_loop.store(true, std::memory_order_relaxed);
      }
      if (!recorder.good()) stop_loop.store(true, std::memory_order_relaxed);
      if (tell) tell(progress_text(progress, setup.time));
      std::this_thread::sleep_for(milliseconds(20));
    }
    loop_thread.join();
  }
  release_memory();
  recorder.finish();
  result.dropped_records = ring.dropped();
  result.answer_hash = engine.answer_hash();
  if (setup.replay != nullptr) {
    result.replay = ReplayAnswer{setup.replay_rows, setup.replay->compared(), setup.replay->unequal(),
                                 setup.replay->first_unequal()};
  }
  return result;
}

scene::Figures figures(const LiveResult& result, const LiveOptions& options) {
  const Ledger& ledger = result.ledger;
  scene::Figures list{
      {"live.device", 0.0, name_of(options.device), ""},
      {"live.rate_hz", static_cast<double>(result.rate_hz), "", "Hz"},
      {"live.planned_s", result.planned_s, "", "s"},
      {"live.ticks", static_cast<double>(ledger.ticks), "", ""},
      {"live.missed", static_cast<double>(ledger.missed), "", ""},
  };
  const auto add = [&](const std::string& key, const fast::DurationHistogram& histogram) {
    fast::add_figures(key, histogram.percentiles(), list);
  };
  add("live.lateness_us", ledger.lateness);
  add("live.step_us", ledger.step);
  add("live.force_us", ledger.force);
  add("live.shape_us", ledger.shape);
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    if (ledger.stages[s].count() > 0) add(std::string("live.stage.") + fast::stage_names[s] + "_us", ledger.stages[s]);
  }
  add("live.shape_age_us", result.shape_age);
  const std::vector<scene::Figure> rest{
      {"live.shapes_read", static_cast<double>(result.shapes_read), "", ""},
      {"live.displacement_max_m", result.displacement_max_m, "", "m"},
      {"live.force_max_n", ledger.force_max_n, "", "N"},
      {"live.model_force_max_n", ledger.model_force_max_n, "", "N"},
      {"live.limited_ticks", static_cast<double>(ledger.limited_ticks), "", ""},
      {"live.bad_poses", static_cast<double>(ledger.bad_poses), "", ""},
      {"live.dropped_records", static_cast<double>(result.dropped_records), "", ""},
      {"live.scheduling", 0.0, result.scheduling.text(), ""},
      {"live.status", 0.0, fast::status_text(ledger.status), ""},
  };
  list.insert(list.end(), rest.begin(), rest.end());
  list.push_back({"live.answer_hash", 0.0, fmt::format("{:016x}", result.answer_hash), ""});
  if (result.replay) {
    list.push_back({"live.replay_compared", static_cast<double>(result.replay->compared), "", ""});
    list.push_back({"live.replay_unequal", static_cast<double>(result.replay->unequal), "", ""});
  }
  return list;
}

std::string summary_text(const LiveResult& result) {
  const Ledger& ledger = result.ledger;
  std::string text;
  const auto say = [&text]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
  };
  const auto percent =
      100.0 * static_cast<double>(ledger.ticks) / std::max<double>(1.0, double(ledger.ticks + ledger.missed));
  say("{} ticks at {} Hz, {} missed ({:.2f} % done), {}\n", ledger.ticks, result.rate_hz, ledger.missed, percent,
      result.scheduling.text());
  const auto row = [&](const std::string& name, const fast::DurationHistogram& histogram) {
    const fast::Percentiles p = histogram.percentiles();
    say("  {:<22} {:10.4g} {:10.4g} {:10.4g} {:10.4g}\n", name, p.p50_us, p.p99_us, p.p999_us, p.max_us);
  };
  say("  {:<22} {:>10} {:>10} {:>10} {:>10}\n", "microseconds", "p50", "p99", "p99.9", "max");
  row("lateness", ledger.lateness);
  row("pose to force", ledger.force);
  row("shape", ledger.shape);
  row("whole tick", ledger.step);
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    if (ledger.stages[s].count() > 0) row(std::string("  ") + fast::stage_names[s], ledger.stages[s]);
  }
  row("age of the shape", result.shape_age);
  say("Largest force sent {:.4g} N (model {:.4g} N); {} ticks limited, {} bad poses, {} records dropped\nStatus: {}\n",
      ledger.force_max_n, ledger.model_force_max_n, ledger.limited_ticks, ledger.bad_poses, result.dropped_records,
      fast::status_text(ledger.status));
  if (!result.replay) return text;
  const ReplayAnswer& replay = *result.replay;
  if (replay.equal()) {
    say("Replay: all {} answers equal the log's to the last bit\n", replay.rows);
  } else if (replay.unequal > 0) {
    say("Replay: {} of {} answers differ from the log's, the first on line {} (same scene file?)\n", replay.unequal,
        replay.compared, replay.first_unequal + 2);
  } else {
    say("Replay: ended after {} of {} ticks, all equal to the log's\n", replay.compared, replay.rows);
  }
  return text;
}

}  // namespace touchstone::live
