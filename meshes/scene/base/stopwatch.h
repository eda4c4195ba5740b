// Wall time and processor time of work that takes milliseconds or more.
#pragma once

#include <chrono>
#include <ctime>
#include <string>

namespace touchstone::scene {

/// Of a named stage [s].
struct StageTime {
  std::string stage;
  double wall_s = 0.0, cpu_s = 0.0;
};

/// Time since construction. The processor time is the process's, all threads together.
class Stopwatch {
 public:
  [[nodiscard]] double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  }
  [[nodiscard]] double cpu_s() const { return static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC; }
  [[nodiscard]] StageTime read(const std::string& stage) const { return {stage, wall_s(), cpu_s()}; }

 private:
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  std::clock_t cpu_ = std::clock();
};

/// Adds the processor time of its life to a sum.
class CpuTimeAdder {
 public:
  explicit CpuTimeAdder(double& sum_s) noexcept : sum_s_(sum_s) {}
  ~CpuTimeAdder() { sum_s_ += watch_.cpu_s(); }
  CpuTimeAdder(const CpuTimeAdder&) = delete;
  CpuTimeAdder& operator=(const CpuTimeAdder&) = delete;

 private:
  double& sum_s_;
  Stopwatch watch_;
};

}  // namespace touchstone::scene
