// How long each stage of a tick takes, for those who ask: bench, plan and the device loop's ledger.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace touchstone::fast {

/// The stages of a tick in their order.
enum class Stage { detection, regions, force, friction, skeleton, interpolation, local_factor, normals };
inline constexpr std::size_t stage_count = 8;
inline constexpr std::array<const char*, stage_count> stage_names = {
    "detection", "regions", "force", "friction", "skeleton", "interpolation", "local_factor", "normals"};

/// Time per stage since the last start(), summed over the regions. Below a step it only reads the clock and adds.
class StageClock {
 public:
  void start() noexcept {
    spent_.fill(Duration::zero());
    resume();
  }
  /// What has passed since the last lap goes to no stage.
  void resume() noexcept { last_ = Clock::now(); }
  /// What has passed since the last lap goes to this stage.
  void lap(Stage stage) noexcept {
    const Clock::time_point now = Clock::now();
    spent_[static_cast<std::size_t>(stage)] += now - last_;
    last_ = now;
  }
  [[nodiscard]] std::int64_t spent_ns(Stage stage) const noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(spent_[static_cast<std::size_t>(stage)]).count();
  }
  /// [us]
  [[nodiscard]] double spent_us(Stage stage) const noexcept {
    return std::chrono::duration<double, std::micro>(spent_[static_cast<std::size_t>(stage)]).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Duration = Clock::duration;
  std::array<Duration, stage_count> spent_{};
  Clock::time_point last_;
};

}  // namespace touchstone::fast
