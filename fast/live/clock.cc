#include "fast/live/clock.h"

#include <time.h>

#include <cerrno>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace touchstone::live {
namespace {

void breathe() noexcept {
#if defined(__SSE2__)
  _mm_pause();
#endif
}

}  // namespace

std::int64_t WallClock::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * second_ns + now.tv_nsec;
}

void WallClock::wait_until(std::int64_t time_ns) noexcept {
  const std::int64_t wake_ns = time_ns - spin_ns_;
  if (wake_ns > now_ns()) {
    const timespec wake{wake_ns / second_ns, wake_ns % second_ns};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) == EINTR) {
    }
  }
  while (now_ns() < time_ns) breathe();
}

}  // namespace touchstone::live
