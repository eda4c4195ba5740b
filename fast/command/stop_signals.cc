#include "fast/command/stop_signals.h"

namespace touchstone::fast {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

extern "C" void ask_to_stop(int) { stop_asked.store(true, std::memory_order_relaxed); }

}  // namespace

StopSignals::StopSignals(Again again) {
  stop_asked.store(false);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction before {
    }, action{};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    action.sa_handler = signal == SIGPIPE ? SIG_IGN : ask_to_stop;
    if (again == Again::end_at_once && signal != SIGPIPE) action.sa_flags = static_cast<int>(SA_RESETHAND);
    action.sa_flags |= SA_RESTART;
    sigaction(signal, &action, nullptr);
    before_.emplace_back(signal, before);
  }
}

StopSignals::~StopSignals() {
  for (const auto& [signal, before] : before_) sigaction(signal, &before, nullptr);
}

const std::atomic<bool>& StopSignals::asked() noexcept { return stop_asked; }

}  // namespace touchstone::fast
