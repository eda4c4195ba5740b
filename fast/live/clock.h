// The loop's time, so that the same loop runs by the wall or in lock-step.
#pragma once

#include <cstdint>

namespace touchstone::live {

inline constexpr std::int64_t second_ns = 1'000'000'000;

class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;
  /// Returns at once where the time has passed.
  virtual void wait_until(std::int64_t time_ns) noexcept = 0;

 protected:
  Clock() = default;
  Clock(const Clock&) = default;
  Clock& operator=(const Clock&) = default;
};

/// Monotonic time. Sleeps to shortly before the deadline and spins the rest: a sleeping thread wakes tens of
/// microseconds late, and one that only spins is stopped by the kernel's real-time throttling for 50 ms a second.
class WallClock final : public Clock {
 public:
  /// @param spin_ns before the deadline
  explicit WallClock(std::int64_t spin_ns) noexcept : spin_ns_(spin_ns) {}
  [[nodiscard]] std::int64_t now_ns() noexcept override;
  void wait_until(std::int64_t time_ns) noexcept override;

 private:
  std::int64_t spin_ns_;
};

/// Lock-step: waiting takes no time, and only advance_ns() makes the loop late.
class VirtualClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  void wait_until(std::int64_t time_ns) noexcept override {
    if (time_ns > now_ns_) now_ns_ = time_ns;
  }
  void advance_ns(std::int64_t duration_ns) noexcept { now_ns_ += duration_ns; }

 private:
  std::int64_t now_ns_ = 0;
};

}  // namespace touchstone::live
