// How many threads a solve may use.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <thread>

namespace touchstone::reference {

/// OMP_NUM_THREADS where it is set to a number, as BLAS and batch systems have it; otherwise the processors that this
/// process may run on. At least 1. The order of sums, and so the last digits of a result, depends on it.
[[nodiscard]] inline int threads_to_use() {
  int asked = 0;
  if (const char* text = std::getenv("OMP_NUM_THREADS")) {
    const std::string_view digits(text);
    std::from_chars(digits.data(), digits.data() + digits.size(), asked);
  }
  return std::max(1, asked > 0 ? asked : static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace touchstone::reference
