#include "reference/run/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

/// Seconds of one thread that a Newton iteration takes.
struct IterationSeconds {
  double per_unknown;      // assembly, and what else grows with the unknowns
  double factor_at_ten_k;  // factorisation and solves at ten thousand unknowns
  double factor_power;     // with which it grows
};

constexpr IterationSeconds in_the_plane{2.4e-6, 0.006, 1.3}, in_space{5e-6, 0.11, 1.45};
constexpr double iterations_per_step = 3.6, iterations_per_step_with_friction = 7.2;
constexpr double shared_between_threads = 0.65;  // of the work

}  // namespace

Cost expected_cost(const MeshWork& work, int threads) {
  const IterationSeconds& one = work.dim == 2 ? in_the_plane : in_space;
  const double iteration_s =
      one.per_unknown * work.unknowns + one.factor_at_ten_k * std::pow(1e-4 * work.unknowns, one.factor_power);
  Cost cost;
  cost.newton_iterations = work.load_steps * (work.friction ? iterations_per_step_with_friction : iterations_per_step);
  const double serial = 1.0 - shared_between_threads;
  cost.seconds = cost.newton_iterations * iteration_s * (serial + shared_between_threads / std::max(1, threads));
  cost.memory_bytes = expected_memory_bytes(work.dim, work.unknowns);
  return cost;
}

double expected_memory_bytes(int dim, double unknowns) {
  constexpr double program_bytes = 0.2e9;  // with its libraries, and small meshes
  return program_bytes + (dim == 2 ? 4e3 * unknowns : 2.4e9 * std::pow(unknowns / 93e3, 1.35));
}

void Pace::finished(double expected_s, double measured_s) noexcept {
  expected_s_ += expected_s;
  measured_s_ += measured_s;
  largest_s_ = std::max(largest_s_, expected_s);
}

double Pace::factor() const noexcept {
  // The model has the weight of one load step, so that a single quick one does not overrule it.
  return expected_s_ > 0.0 ? (largest_s_ + measured_s_) / (largest_s_ + expected_s_) : 1.0;
}

std::string duration_text(double seconds) {
  if (seconds < 99.5) return fmt::format("{:.{}f} s", seconds, seconds < 9.95 ? 1 : 0);
  if (seconds < 99.5 * 60.0) return fmt::format("{:.{}f} min", seconds / 60.0, seconds < 600.0 ? 1 : 0);
  return fmt::format("{:.{}f} h", seconds / 3600.0, seconds < 36e3 ? 1 : 0);
}

std::string memory_text(double bytes) {
  const double gibibytes = bytes / (1024.0 * 1024.0 * 1024.0);
  return gibibytes < 100.0 ? fmt::format("{:.2g} GiB", gibibytes) : fmt::format("{} GiB", std::lround(gibibytes));
}

}  // namespace touchstone::reference
