// How many threads a solve may use.
#pragma once

#include <string_view>

namespace touchstone::reference {

/// OMP_NUM_THREADS where it is set to a number, as BLAS and batch systems have it; otherwise the processors that
/// nothing else used when this was first asked. At least 1. The order of sums, and so the last digits of a result,
/// depends on it.
[[nodiscard]] int threads_to_use();

/// Processors that nothing but the calling thread uses now; at least 1. The threads of BLAS wait for each other, so one
/// that must wait for a processor holds up the others: on a busy machine fewer are faster.
[[nodiscard]] int idle_processors();

/// Threads that run or wait for a processor, of all processes, from the text of /proc/loadavg; 0 where that has no such
/// number.
[[nodiscard]] int runnable_threads(std::string_view loadavg) noexcept;

}  // namespace touchstone::reference
