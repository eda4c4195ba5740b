#include "reference/verification/problem.h"

#include "reference/run/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace touchstone::verification {

double Check::error() const noexcept { return (value - target) / (scale > 0.0 ? scale : std::abs(target)); }

bool Check::passes() const noexcept { return std::abs(error()) <= limit; }

Check from_levels(std::string what, std::string unit, double target, double limit, const std::vector<double>& values) {
  Check check{std::move(what), std::move(unit), target, values.back(), limit, 0.0, {}, {}};
  const std::size_t n = values.size();
  if (n < 3) return check;
  std::vector<std::vector<double>> levels;
  std::vector<double> finer;
  for (std::size_t k = 0; k < n; ++k) {
    levels.push_back({values[k]});
    finer.push_back(std::exp2(k));
  }
  check.mesh_band = reference::force_band(levels, finer).front() / std::abs(target);
  check.order = observed_order(values[n - 2] - values[n - 3], values[n - 1] - values[n - 2]);
  return check;
}

std::optional<double> observed_order(double coarse_error, double fine_error) {
  const double ratio = coarse_error / fine_error;
  if (!(ratio > 1.0) || std::isinf(ratio)) return {};
  return std::log2(ratio);
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = [] {
    std::vector<Problem> list = solid_problems();
    std::ranges::move(contact_problems(), std::back_inserter(list));
    return list;
  }();
  return all;
}

}  // namespace touchstone::verification
