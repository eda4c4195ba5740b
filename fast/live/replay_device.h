// A recorded log as a device.
#pragma once

#include "fast/live/device_loop.h"

#include <vector>

namespace touchstone::live {

/// Gives the recorded poses one per tick done, bit by bit, and keeps count of answers that differ. A tick missed in the
/// replay is not a row passed by, or the model's memory of earlier poses would differ: the replay takes longer.
class ReplayDevice final : public Device, public TickListener {
 public:
  /// @param ticks of a log; at least one
  explicit ReplayDevice(std::vector<TickRecord> ticks) : ticks_(std::move(ticks)) {}

  [[nodiscard]] std::uint32_t capabilities() const noexcept override {
    return senses_position | senses_orientation | senses_buttons | simulated;
  }
  [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override;
  void write(const Wrench&) noexcept override {}

  /// Compares the model's and the published wrench to the recorded ones, bit by bit.
  void tick_done(const TickRecord& record) noexcept override;

  [[nodiscard]] std::int64_t compared() const noexcept { return compared_; }
  [[nodiscard]] std::int64_t unequal() const noexcept { return unequal_; }
  /// Row of the first answer that differs; -1: none.
  [[nodiscard]] std::int64_t first_unequal() const noexcept { return first_unequal_; }

 private:
  std::vector<TickRecord> ticks_;
  std::size_t next_ = 0;
  std::int64_t compared_ = 0, unequal_ = 0, first_unequal_ = -1;
};

}  // namespace touchstone::live
