// What the operating system grants the loop's thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace touchstone::live {

/// What is asked for.
struct SchedulingWish {
  int priority = 50;             ///< of SCHED_FIFO
  std::optional<int> processor;  ///< absent: the last one this process may use, where SCHED_FIFO is granted
};

/// What came of it.
struct Scheduling {
  bool fifo = false, locked = false, pinned = false;
  int priority = 0, processor = -1;
  std::vector<std::string> warnings;  ///< one per refusal: what it costs, and what would grant it

  /// "SCHED_FIFO 50, memory locked, on processor 1".
  [[nodiscard]] std::string text() const;
};

/// Threads started from here on have a stack of 2 MiB each, regardless of the limit: locked memory holds all of it.
void give_threads_small_stacks() noexcept;

/// Asks for SCHED_FIFO and a processor of its own for the calling thread, and for the process's present memory to stay
/// in place. The loop needs none of them to be right, only to be punctual.
///
/// Only present memory: the loop takes none later, and locking what is still to come would make the other threads'
/// allocations fail where locked memory is limited. And not when it is more than 2 GiB, as it is where libraries have
/// threads of their own and the limit for stacks is high: to lock it is to use it.
[[nodiscard]] Scheduling schedule_this_thread(const SchedulingWish& wish);

/// Gives the locked memory back.
void release_memory() noexcept;

/// Keeps the interrupt and end signals of the process from this thread.
void block_signals() noexcept;

}  // namespace touchstone::live
