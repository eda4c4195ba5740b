// Where the processor's time goes.
#pragma once

#include <ctime>

namespace touchstone::reference {

/// Adds the processor time that the process spends in its life, all threads together, to a sum.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_s) noexcept : sum_s_(sum_s), begin_(std::clock()) {}
  ~Stopwatch() { sum_s_ += static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_s_;
  std::clock_t begin_;
};

}  // namespace touchstone::reference
