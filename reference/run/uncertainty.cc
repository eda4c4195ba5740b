#include "reference/run/uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchstone::reference {
namespace {

constexpr double safety = 1.25;
constexpr double closest_pair = 1.4;

constexpr double unknown_uncertainty = std::numeric_limits<double>::quiet_NaN();

/// Two levels and what the difference between them is worth at the finest one.
struct Pair {
  std::size_t coarse, fine;
  double weight;
};

/// @param order  of the error in 1 / f
std::vector<Pair> pairs(const std::vector<double>& finer, double order = 1.0) {
  const std::size_t last = finer.size() - 1;
  const auto ratio = [&](std::size_t level) { return std::pow(finer[last] / finer[level], order); };
  std::vector<Pair> list;
  for (const auto [coarse, fine] : {std::array{last - 1, last}, {last - 2, last}, {last - 2, last - 1}}) {
    const bool widest = coarse + 2 == fine;
    if (!widest && finer[fine] < closest_pair * finer[coarse]) continue;
    list.push_back({coarse, fine, 1.0 / (ratio(coarse) - ratio(fine))});
  }
  return list;
}

/// The order, between 1 and most, of an error whose values on the last three levels differ by these.
double order_shown(double coarser, double finest, const std::vector<double>& finer, double most) {
  const auto f = [&](std::size_t from_last, double order) { return std::pow(*(finer.rbegin() + from_last), -order); };
  double low = 1.0, high = most;
  while (high - low > 1e-6) {
    const double order = 0.5 * (low + high);
    const double left = (f(1, order) - f(0, order)) / (f(2, order) - f(1, order));
    (finest < left * coarser ? low : high) = order;
  }
  return low;
}

}  // namespace

std::vector<double> force_band(const std::vector<std::vector<double>>& levels, const std::vector<double>& finer,
                               const BandRule& rule) {
  const std::size_t instants = levels.empty() ? 0 : levels.back().size(), count = levels.size();
  if (count < 3) return std::vector<double>(instants, unknown_uncertainty);
  const auto apart = [&](std::size_t coarse, std::size_t fine, std::size_t i) {
    return std::abs(levels[fine][i] - levels[coarse][i]);
  };
  /// Over an instant and its neighbours.
  const auto largest = [&](std::size_t i, const auto& value) {
    double found = value(i);
    for (const std::size_t next : {i - 1, i + 1}) {
      if (next >= instants) continue;  // so is what is before the first
      if (!rule.refined_for.empty() && rule.refined_for[i] && !rule.refined_for[next]) continue;
      found = std::max(found, value(next));
    }
    return found;
  };
  std::vector<double> own(instants, 0.0), band(instants);
  for (std::size_t i = 0; i < instants; ++i) {
    const auto change = [&](std::size_t coarse) {
      return largest(i, [&](std::size_t near) { return apart(coarse, coarse + 1, near); });
    };
    const double order =
        rule.most_order > 1.0 ? order_shown(change(count - 3), change(count - 2), finer, rule.most_order) : 1.0;
    for (const Pair& pair : pairs(finer, order)) {
      own[i] = std::max(own[i], safety * pair.weight * apart(pair.coarse, pair.fine, i));
    }
  }
  for (std::size_t i = 0; i < instants; ++i) band[i] = largest(i, [&](std::size_t near) { return own[near]; });
  return band;
}

template <int rows>
std::vector<Eigen::VectorXd> point_band(
    const std::vector<std::vector<Eigen::Matrix<double, rows, Eigen::Dynamic>>>& levels,
    const std::vector<double>& finer) {
  const std::size_t instants = levels.empty() ? 0 : levels.back().size();
  std::vector<Eigen::VectorXd> own(instants), band(instants);
  for (std::size_t i = 0; i < instants; ++i) {
    const Eigen::Index points = levels.back()[i].cols();
    if (levels.size() < 3) {
      own[i] = Eigen::VectorXd::Constant(points, unknown_uncertainty);
      continue;
    }
    own[i].setZero(points);
    for (const Pair& pair : pairs(finer)) {
      const Eigen::Matrix<double, rows, Eigen::Dynamic> change = levels[pair.fine][i] - levels[pair.coarse][i];
      own[i] = own[i].cwiseMax(safety * pair.weight * change.colwise().norm().transpose());
    }
  }
  for (std::size_t i = 0; i < instants; ++i) {
    band[i] = own[i];
    if (i > 0) band[i] = band[i].cwiseMax(own[i - 1]);
    if (i + 1 < instants) band[i] = band[i].cwiseMax(own[i + 1]);
  }
  return band;
}

template <int rows>
using Levels = std::vector<std::vector<Eigen::Matrix<double, rows, Eigen::Dynamic>>>;
template std::vector<Eigen::VectorXd> point_band<3>(const Levels<3>&, const std::vector<double>&);
template std::vector<Eigen::VectorXd> point_band<9>(const Levels<9>&, const std::vector<double>&);

std::vector<bool> deep_instants(const scene::Instants& instants) {
  double deepest_m = 0.0;
  for (const scene::InstantRecord& instant : instants) deepest_m = std::max(deepest_m, instant.depth_m);
  std::vector<bool> deep;
  for (const scene::InstantRecord& instant : instants) {
    deep.push_back(instant.depth_m > grazing_depth_m && instant.depth_m > deep_share * deepest_m);
  }
  return deep;
}

std::optional<double> force_uncertainty_rel(const std::vector<scene::ReferenceInstant>& instants) {
  std::optional<double> largest;
  const std::vector<bool> deep = deep_instants(instants);
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const double force_n = instants[i].force_n().norm();
    if (!deep[i] || force_n == 0.0) continue;
    const double here = instants[i].force_uncertainty_n / force_n;
    // Once NaN, stays NaN.
    if (!largest || std::isnan(here) || here > *largest) largest = here;
  }
  return largest;
}

std::optional<double> shape_uncertainty_rel(const std::vector<scene::ReferenceInstant>& instants,
                                            const std::vector<double>& area_m2) {
  double uncertain = 0.0, moved = 0.0;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const Eigen::VectorXd area = areas_or_ones(area_m2, instants[i].displacement_m.cols());
    uncertain += instants[i].displacement_uncertainty_m.cwiseAbs2().dot(area);
    moved += instants[i].displacement_m.colwise().squaredNorm().transpose().dot(area);
  }
  if (moved == 0.0) return std::nullopt;
  return std::sqrt(uncertain / moved);
}

Eigen::VectorXd areas_or_ones(const std::vector<double>& area_m2, Eigen::Index points) {
  if (area_m2.empty()) return Eigen::VectorXd::Ones(points);
  return Eigen::Map<const Eigen::VectorXd>(area_m2.data(), static_cast<Eigen::Index>(area_m2.size()));
}

}  // namespace touchstone::reference
