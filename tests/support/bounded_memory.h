// For tests of work that must need little memory.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <functional>
#include <new>
#include <string>

namespace touchstone {

/// Memory that this process may write to [byte].
inline std::size_t writable_bytes() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("VmData:")) return 1024 * std::stoul(line.substr(7));
  }
  return 0;
}

/// Whether a process of its own can do the work with this much more memory than the present one. Not under the address
/// sanitizer, which has memory of its own.
[[nodiscard]] inline bool done_within(std::size_t bytes, const std::function<bool()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit small{writable_bytes() + bytes, RLIM_INFINITY};
    ::setrlimit(RLIMIT_DATA, &small);
    bool done = false;
    try {
      done = work();
    } catch (const std::bad_alloc&) {
    }
    ::_exit(done ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  return status == 0;
}

}  // namespace touchstone
