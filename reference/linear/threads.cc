#include "reference/linear/threads.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

namespace touchstone::reference {

int threads_to_use() {
  static const int threads = [] {
    int asked = 0;
    if (const char* text = std::getenv("OMP_NUM_THREADS")) {
      const std::string_view digits(text);
      std::from_chars(digits.data(), digits.data() + digits.size(), asked);
    }
    return asked > 0 ? asked : idle_processors();
  }();
  return threads;
}

int idle_processors() {
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  // The smallest of several readings: a process that runs only for a moment is no load.
  int others = processors;
  for (int look = 0; look < 8 && others > 0; ++look) {
    if (look > 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::string line;
    std::getline(std::ifstream("/proc/loadavg"), line);
    others = std::min(others, std::max(0, runnable_threads(line) - 1));
  }
  return std::max(1, processors - others);
}

int runnable_threads(std::string_view loadavg) noexcept {
  // "0.00 0.01 0.05 1/123 4567": three load averages, running threads/all threads, the last process
  for (int word = 0; word < 3; ++word) loadavg.remove_prefix(std::min(loadavg.find(' ') + 1, loadavg.size()));
  int count = 0;
  std::from_chars(loadavg.data(), loadavg.data() + loadavg.size(), count);
  return count;
}

}  // namespace touchstone::reference
