// An error with the reference's own uncertainty, and the sums and maxima that errors are made from.
#pragma once

#include <cmath>
#include <optional>

namespace touchstone::compare {

/// An error and the reference's own uncertainty in the same norm.
struct Measure {
  std::optional<double> value;        ///< absent if undefined, such as a ratio to zero force
  std::optional<double> uncertainty;  ///< absent where the reference does not give it

  /// False where the error is no larger than the reference's uncertainty: the two sides may then agree.
  [[nodiscard]] bool distinguishable() const noexcept {
    return value && (!uncertainty || !(std::abs(*value) <= *uncertainty));
  }
};

/// Known only when finite: a reference with too few levels has no uncertainty.
[[nodiscard]] inline std::optional<double> known(double uncertainty) {
  return std::isfinite(uncertainty) ? std::optional(uncertainty) : std::nullopt;
}

/// Keeps the larger; NaN is kept, so that a maximum does not hide it.
inline void keep_larger(double& largest, double value) {
  if (std::isnan(value) || value > largest) largest = value;
}

inline void keep_larger(std::optional<double>& largest, double value) {
  double kept = largest.value_or(value);
  keep_larger(kept, value);
  largest = kept;
}

/// Accumulates sqrt(sum w e^2 / sum w s^2), a relative L2 error.
struct SquareSums {
  double error = 0.0, uncertainty = 0.0, scale = 0.0;

  void add(double weight, double error_by, double uncertainty_by, double scale_by) {
    error += weight * error_by * error_by;
    uncertainty += weight * uncertainty_by * uncertainty_by;
    scale += weight * scale_by * scale_by;
  }
  [[nodiscard]] Measure relative() const {
    if (scale == 0.0) return {};
    return {std::sqrt(error / scale), known(std::sqrt(uncertainty / scale))};
  }
};

/// Root mean square over a number of instants, relative to one scale.
struct MeanSquares {
  double error = 0.0, uncertainty = 0.0;
  int count = 0;

  void add(double error_by, double uncertainty_by) {
    error += error_by * error_by;
    uncertainty += uncertainty_by * uncertainty_by;
    ++count;
  }
  [[nodiscard]] Measure over(double scale) const {
    return {std::sqrt(error / count) / scale, known(std::sqrt(uncertainty / count) / scale)};
  }
};

}  // namespace touchstone::compare
