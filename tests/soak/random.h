// Random numbers that are the same with every standard library.
#pragma once

#include "scene/base/frames.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace touchstone::soak {

class Random {
 public:
  /// One stream of numbers for each seed and each scene number.
  Random(std::uint64_t seed, std::uint64_t stream) : engine_(mixed(mixed(seed) + stream)) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  /// Uniform in the logarithm. @param low > 0
  double decades(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// 0 to count - 1.
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  scene::Vec3 direction() {
    const double z = uniform(-1.0, 1.0), turn = uniform(-std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  Eigen::Quaterniond turn(double largest_rad) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(uniform(-largest_rad, largest_rad), direction()));
  }

 private:
  /// Neighbouring seeds give uncorrelated streams (the finaliser of splitmix64).
  static std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
  }
  std::mt19937_64 engine_;
};

}  // namespace touchstone::soak
