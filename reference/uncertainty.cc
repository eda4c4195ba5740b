#include "reference/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::reference {
namespace {

constexpr double safety = 1.25;

}  // namespace

std::vector<double> force_band(const std::vector<std::vector<double>>& levels) {
  const std::size_t instants = levels.empty() ? 0 : levels.back().size();
  if (levels.size() < 3) return std::vector<double>(instants, std::numeric_limits<double>::infinity());
  const auto& F0 = levels[levels.size() - 3];
  const auto& F1 = levels[levels.size() - 2];
  const auto& F2 = levels[levels.size() - 1];
  std::vector<double> own(instants), band(instants);
  for (std::size_t i = 0; i < instants; ++i) {
    own[i] = safety * std::max(std::abs(F2[i] - F1[i]), 0.5 * std::abs(F1[i] - F0[i]));
  }
  for (std::size_t i = 0; i < instants; ++i) {
    band[i] = own[i];
    if (i > 0) band[i] = std::max(band[i], own[i - 1]);
    if (i + 1 < instants) band[i] = std::max(band[i], own[i + 1]);
  }
  return band;
}

std::vector<Eigen::VectorXd> displacement_band(const std::vector<std::vector<Eigen::Matrix3Xd>>& levels) {
  const std::size_t instants = levels.empty() ? 0 : levels.back().size();
  std::vector<Eigen::VectorXd> own(instants), band(instants);
  for (std::size_t i = 0; i < instants; ++i) {
    const Eigen::Index points = levels.back()[i].cols();
    if (levels.size() < 3) {
      own[i] = Eigen::VectorXd::Constant(points, std::numeric_limits<double>::infinity());
      continue;
    }
    const auto& u0 = levels[levels.size() - 3][i];
    const auto& u1 = levels[levels.size() - 2][i];
    const auto& u2 = levels[levels.size() - 1][i];
    own[i] = safety * (u2 - u1).colwise().norm().cwiseMax(0.5 * (u1 - u0).colwise().norm()).transpose();
  }
  for (std::size_t i = 0; i < instants; ++i) {
    band[i] = own[i];
    if (i > 0) band[i] = band[i].cwiseMax(own[i - 1]);
    if (i + 1 < instants) band[i] = band[i].cwiseMax(own[i + 1]);
  }
  return band;
}

}  // namespace touchstone::reference
