// Instructions and cycles of this thread, counted by the processor where the system permits it.
#pragma once

#include <cstdint>
#include <string>

namespace touchstone::bench {

/// Outside the kernel only. Where counting is not permitted or the machine has no counters, it reports so and counts
/// nothing.
class HardwareCounters {
 public:
  HardwareCounters();
  ~HardwareCounters();
  HardwareCounters(const HardwareCounters&) = delete;
  HardwareCounters& operator=(const HardwareCounters&) = delete;

  [[nodiscard]] bool counting() const noexcept { return instructions_ >= 0 && cycles_ >= 0; }
  /// "counted", or why not.
  [[nodiscard]] const std::string& state() const noexcept { return state_; }
  void start() noexcept;
  struct Counts {
    double instructions = 0.0, cycles = 0.0;
  };
  /// Since the last start().
  Counts stop() noexcept;

 private:
  int instructions_ = -1, cycles_ = -1;  ///< file descriptors
  std::string state_;
};

}  // namespace touchstone::bench
