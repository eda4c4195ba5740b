// Ctrl-C, a batch system's SIGTERM and a closed terminal's SIGHUP as a request to end well.
#pragma once

#include <atomic>
#include <csignal>
#include <utility>
#include <vector>

namespace touchstone::fast {

/// While it lives, these signals set a flag and do nothing else, and a reader that has gone (SIGPIPE) ends nothing. A
/// process that was started to outlive its terminal (nohup) goes on.
class StopSignals {
 public:
  /// What a signal does that came before.
  enum class Again { nothing, end_at_once };

  explicit StopSignals(Again again);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Whether one came since the last object was made. Any thread.
  [[nodiscard]] static const std::atomic<bool>& asked() noexcept;

 private:
  std::vector<std::pair<int, struct sigaction>> before_;
};

}  // namespace touchstone::fast
