#include "scene/base/range.h"

#include "scene/base/text.h"

#include <fmt/format.h>

#include <cmath>

namespace touchstone::scene {

bool Range::contains(double value) const noexcept {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  return fmt::format("{}{:g}, {:g}{}", low_open ? '(' : '[', low, high, high_open ? ')' : ']');
}

std::optional<Eigen::Quaterniond> orientation_of(const Eigen::Quaterniond& q) {
  if (!orientation_norm.contains(q.norm())) return std::nullopt;
  // A length that differs from one only by rounding is not divided by: repeated reading would change the last digits.
  constexpr double rounding = 2e-15;
  return std::abs(q.squaredNorm() - 1.0) < rounding ? q : q.normalized();
}

}  // namespace touchstone::scene
