// Ranges of allowed values, and which quaternions are orientations.
#pragma once

#include <Eigen/Geometry>

#include <limits>
#include <optional>
#include <string>

namespace touchstone::scene {

/// Allowed values of a number, or of every element of a vector.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;

  [[nodiscard]] bool contains(double value) const noexcept;  ///< false for NaN
  [[nodiscard]] std::string text() const;                    ///< "(0, 0.5]"
};

/// How long a quaternion may be that is meant as an orientation. One far from 1 is a slip, and the squares of a very
/// short or long one lose its digits.
inline constexpr double orientation_norm_max = 2.0;
inline constexpr Range orientation_norm{0.5, orientation_norm_max};

/// At unit length, and such that what is written out reads back bit for bit; nothing for a norm out of range.
[[nodiscard]] std::optional<Eigen::Quaterniond> orientation_of(const Eigen::Quaterniond& q);

}  // namespace touchstone::scene
