#include "fast/command/stop_signals.h"

#include "fast/command/exit_code.h"

#include <unistd.h>

namespace touchstone::fast {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

extern "C" void ask_to_stop(int) { stop_asked.store(true, std::memory_order_relaxed); }

std::string last_words;

extern "C" void say_and_end_at_once(int) {
  static_cast<void>(!::write(STDERR_FILENO, last_words.data(), last_words.size()));
  ::_exit(interrupted);
}

using Actions = std::vector<std::pair<int, struct sigaction>>;

void set(int signal, void (*handler)(int), int flags, Actions& before) {
  struct sigaction now {
  }, action{};
  sigaction(signal, nullptr, &now);
  if (signal == SIGHUP && now.sa_handler == SIG_IGN) return;
  action.sa_handler = handler;
  action.sa_flags = flags | SA_RESTART;
  sigaction(signal, &action, nullptr);
  before.emplace_back(signal, now);
}

void restore(const Actions& before) {
  for (const auto& [signal, action] : before) sigaction(signal, &action, nullptr);
}

}  // namespace

StopSignals::StopSignals(Again again) {
  stop_asked.store(false);
  const int flags = again == Again::end_at_once ? static_cast<int>(SA_RESETHAND) : 0;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) set(signal, ask_to_stop, flags, before_);
  set(SIGPIPE, SIG_IGN, 0, before_);
}

StopSignals::~StopSignals() { restore(before_); }

EndSignals::EndSignals(const std::string& sentence) {
  // A progress line on a terminal is ended first.
  last_words = (::isatty(STDERR_FILENO) == 1 ? "\n" : "") + sentence + '\n';
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) set(signal, say_and_end_at_once, 0, before_);
}

EndSignals::~EndSignals() { restore(before_); }

const std::atomic<bool>& StopSignals::asked() noexcept { return stop_asked; }

}  // namespace touchstone::fast
