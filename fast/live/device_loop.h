// The loop between device and model, one tick per period of an absolute grid.
#pragma once

#include "fast/live/clock.h"
#include "fast/live/device.h"
#include "fast/live/ledger.h"
#include "fast/live/record_ring.h"
#include "fast/live/safety.h"
#include "fast/live/tick_record.h"
#include "fast/live/triple_buffer.h"
#include "fast/step/engine.h"

#include <atomic>
#include <cstdint>
#include <limits>

namespace touchstone::live {

/// Follows the ticks on the loop's own thread; as bound by its rules as a device.
class TickListener {
 public:
  virtual ~TickListener() = default;
  virtual void tick_done(const TickRecord& record) noexcept = 0;

 protected:
  TickListener() = default;
  TickListener(const TickListener&) = default;
  TickListener& operator=(const TickListener&) = default;
};

/// What other threads may read while the loop runs.
struct LoopProgress {
  std::atomic<std::int64_t> ticks{0}, missed{0};
  std::atomic<double> force_n{0.0};  ///< norm of the published force
  static_assert(std::atomic<double>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);
};

/// Grid of the loop.
struct LoopTime {
  int rate_hz = 1000;
  std::int64_t grid_points = 0;                                   ///< the loop ends behind the last of them,
  std::int64_t ticks = std::numeric_limits<std::int64_t>::max();  ///< or after this many ticks done

  [[nodiscard]] double period_s() const noexcept { return 1.0 / rate_hz; }
  /// Time of a grid point. The same division everywhere: a log is checked against it.
  [[nodiscard]] double time_s(std::int64_t index) const noexcept { return static_cast<double>(index) / rate_hz; }
  /// The same in whole nanoseconds, without drift.
  [[nodiscard]] std::int64_t time_ns(std::int64_t index) const noexcept {
    return index / rate_hz * 1'000'000'000 + index % rate_hz * 1'000'000'000 / rate_hz;
  }
};

/// Whom the loop connects; what is null is left out.
struct LoopPorts {
  Device& device;
  fast::Engine& engine;
  WrenchLimiter& limiter;
  Clock& clock;
  TripleBuffer<ShapeFrame>* shapes = nullptr;
  RecordRing<TickRecord>* records = nullptr;
  TickListener* listener = nullptr;
  LoopProgress* progress = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< ends the loop after the current tick
};

/// Runs the loop on the calling thread. Per tick: wait for the grid point, read the pose, force step, limits, force to
/// the device, shape step, shape and record published. No heap, lock, log or file access, and no waiting for another
/// thread, from the first tick to the last; numbers below the range of full precision are zero.
///
/// A tick that starts less than a period late is done late. What lies longer back is missed and never caught up with:
/// the loop goes on at the newest grid point. Every grid point passed is either in ledger.ticks or in ledger.missed.
/// At the end the wrench fades to zero as after a bad pose; these writes are no ticks.
void run_device_loop(const LoopTime& time, const LoopPorts& ports, Ledger& ledger) noexcept;

}  // namespace touchstone::live
