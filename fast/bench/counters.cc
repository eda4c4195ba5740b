#include "fast/bench/counters.h"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace touchstone::bench {
namespace {

int open_counter(std::uint64_t what) noexcept {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = what;
  attributes.disabled = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
}

double read_counter(int file) noexcept {
  std::uint64_t count = 0;
  return read(file, &count, sizeof count) == sizeof count ? static_cast<double>(count) : 0.0;
}

}  // namespace

HardwareCounters::HardwareCounters() : instructions_(open_counter(PERF_COUNT_HW_INSTRUCTIONS)), state_("counted") {
  int error = instructions_ < 0 ? errno : 0;
  if (error == 0) {
    cycles_ = open_counter(PERF_COUNT_HW_CPU_CYCLES);
    if (cycles_ < 0) error = errno;
  }
  if (error == EACCES || error == EPERM) {
    state_ = "not permitted (kernel.perf_event_paranoid)";
  } else if (error == ENOENT || error == ENODEV || error == EOPNOTSUPP || error == ENOSYS) {
    state_ = "not there (the machine has no counters, or hides them)";
  } else if (error != 0) {
    state_ = std::string("not opened (") + std::strerror(error) + ")";
  }
}

HardwareCounters::~HardwareCounters() {
  if (instructions_ >= 0) close(instructions_);
  if (cycles_ >= 0) close(cycles_);
}

void HardwareCounters::start() noexcept {
  if (!counting()) return;
  for (const int file : {instructions_, cycles_}) {
    ioctl(file, PERF_EVENT_IOC_RESET, 0);
    ioctl(file, PERF_EVENT_IOC_ENABLE, 0);
  }
}

HardwareCounters::Counts HardwareCounters::stop() noexcept {
  if (!counting()) return {};
  for (const int file : {instructions_, cycles_}) ioctl(file, PERF_EVENT_IOC_DISABLE, 0);
  return {read_counter(instructions_), read_counter(cycles_)};
}

}  // namespace touchstone::bench
