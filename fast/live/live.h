// A live run: the loop on its thread, the shape's reader and the recorder on theirs, a result folder at the end.
#pragma once

#include "fast/live/device_loop.h"
#include "fast/live/history.h"
#include "fast/live/scheduling.h"
#include "scene/model/scene.h"
#include "scene/output/results.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace touchstone::live {

enum class DeviceKind { scripted, replay, hand };

struct LiveOptions {
  DeviceKind device = DeviceKind::scripted;
  std::optional<double> seconds;  ///< absent: the track's length, the log's, or 10 for the hand
  std::optional<int> rate_hz;     ///< 1 to 10000; absent: the log's, or 1000
  std::filesystem::path log;      ///< replay: live.csv of an earlier run
  SchedulingWish scheduling;
  std::size_t ring_records = 16384;  ///< capacity of the ring between loop and recorder
};

/// How a replay compares to its log.
struct ReplayAnswer {
  std::int64_t rows = 0;      ///< of the log that the run was to play
  std::int64_t compared = 0;  ///< played
  std::int64_t unequal = 0;   ///< whose model or published wrench differs in any bit
  std::int64_t first_unequal = -1;

  [[nodiscard]] bool equal() const noexcept { return unequal == 0 && compared == rows; }
};

struct LiveResult {
  Ledger ledger;
  RunHistory history;
  Scheduling scheduling;
  fast::DurationHistogram shape_age;  ///< of the newest published shape, when the reader looked
  std::int64_t shapes_read = 0;
  double displacement_max_m = 0.0;  ///< largest that the reader saw
  std::uint64_t dropped_records = 0;
  std::uint64_t answer_hash = 0;  ///< Engine::answer_hash
  int rate_hz = 0;
  double planned_s = 0.0;
  bool interrupted = false;
  std::optional<ReplayAnswer> replay;
};

/// Runs the loop in real time and writes live.csv meanwhile.
/// @param stop     ends the run early, with all written; polled
/// @param tell     called a few times a second from the calling thread with a line of progress; may be empty
/// @param warn     called once per refused request to the system, before the first line of progress; may be empty
/// @throws scene::InputError for options or a log that cannot be; std::filesystem::filesystem_error where the log
/// cannot
///   be written
[[nodiscard]] LiveResult run_live(const scene::Scene& scene, const LiveOptions& options,
                                  const std::filesystem::path& folder, const std::atomic<bool>& stop,
                                  const std::function<void(const std::string&)>& tell,
                                  const std::function<void(const std::string&)>& warn);

/// The live.* keys of summary.json.
[[nodiscard]] scene::Figures figures(const LiveResult& result, const LiveOptions& options);

/// The ledger for the terminal.
[[nodiscard]] std::string summary_text(const LiveResult& result);

[[nodiscard]] std::string name_of(DeviceKind device);

}  // namespace touchstone::live
