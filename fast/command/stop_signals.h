// Ctrl-C, a batch system's SIGTERM and a closed terminal's SIGHUP as a request to end well.
#pragma once

#include <atomic>
#include <csignal>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::fast {

/// While it exists, these signals only set a flag, and a closed output (SIGPIPE) does not end the program. A
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

/// While it exists, Ctrl-C, SIGTERM and SIGHUP end the process at once with a sentence on stderr: for work that cannot
/// look at a flag and has nothing to keep.
class EndSignals {
 public:
  explicit EndSignals(const std::string& sentence);
  ~EndSignals();
  EndSignals(const EndSignals&) = delete;
  EndSignals& operator=(const EndSignals&) = delete;

 private:
  std::vector<std::pair<int, struct sigaction>> before_;
};

}  // namespace touchstone::fast
