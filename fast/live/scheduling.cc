#include "fast/live/scheduling.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

namespace touchstone::live {
namespace {

constexpr std::uint64_t locked_max = std::uint64_t{2} << 30, stack_size = std::uint64_t{2} << 20;

/// Address space of the process in bytes; zero if the kernel does not tell.
std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// The last processor of the set; -1 if it is empty.
int last_of(const cpu_set_t& set) {
  for (int cpu = CPU_SETSIZE - 1; cpu >= 0; --cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &set)) return cpu;
  }
  return -1;
}

}  // namespace

std::string Scheduling::text() const {
  return (fifo ? "SCHED_FIFO " + std::to_string(priority) : std::string("SCHED_OTHER")) +
         (locked ? ", memory locked" : ", memory not locked") +
         (pinned ? ", on processor " + std::to_string(processor) : ", on any processor");
}

void give_threads_small_stacks() noexcept {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return;
  if (pthread_attr_setstacksize(&attributes, stack_size) == 0) pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

Scheduling schedule_this_thread(const SchedulingWish& wish) {
  Scheduling granted;
  const auto refused = [&](const std::string& what, int error, const std::string& advice) {
    granted.warnings.push_back(what + " refused (" + std::strerror(error) + "): " + advice);
  };

  if (const std::uint64_t bytes = address_space(); bytes > locked_max) {
    granted.warnings.push_back(
        "locked memory left out (" + std::to_string(bytes >> 20) +
        " MiB; expected at most 2048): a page fault may delay a tick; lower the limit for stacks, "
        "ulimit -s");
  } else if (mlockall(MCL_CURRENT) == 0) {
    granted.locked = true;
  } else {
    refused("locked memory", errno, "a page fault may delay a tick; raise the memlock limit");
  }

  sched_param parameter{};
  parameter.sched_priority = wish.priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  if (error == 0) {
    granted.fifo = true;
    granted.priority = wish.priority;
  } else {
    // The kernel wakes ordinary threads up to 50 us late on purpose, to wake several at once; turn this off.
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    refused("SCHED_FIFO", error, "other work will delay ticks; raise the rtprio limit");
  }

  // An ordinary thread may move to another processor when its own is busy, so it is not bound.
  if (granted.fifo || wish.processor) {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
      // Interrupts and the kernel's own threads mostly run on the first processor.
      const int processor = wish.processor.value_or(last_of(allowed));
      cpu_set_t one;
      CPU_ZERO(&one);
      if (processor >= 0 && processor < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(processor), &one);
      const int refusal = pthread_setaffinity_np(pthread_self(), sizeof one, &one);
      if (refusal == 0) {
        granted.pinned = true;
        granted.processor = processor;
      } else {
        refused("processor " + std::to_string(processor), refusal,
                "the loop may move between processors; choose one that this process may use");
      }
    } else {
      refused("a processor of its own", errno, "the loop may move between processors");
    }
  }
  return granted;
}

void release_memory() noexcept { munlockall(); }

void block_signals() noexcept {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace touchstone::live
