// Interpolation between the points of a load grid.
#pragma once

#include "scene/response/load_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::scene {

/// Cubic interpolation with a continuous first derivative, the slope at a point that of the parabola through it and
/// its neighbours: exact for quadratics. Up to four points in each direction.
struct LineWeights {
  int first = 0;
  std::array<double, 4> weight{};

  /// @param x in steps, held inside the grid; @param count of its points, at least 3
  LineWeights(double x, int count) noexcept {
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, count - 2);
    const double t = std::clamp(x - i, 0.0, 1.0);
    first = std::clamp(i - 1, 0, std::max(count - 4, 0));
    const double s = 1.0 - t;
    add(i, s * s * (1.0 + 2.0 * t));
    add(i + 1, t * t * (3.0 - 2.0 * t));
    add_slope(i, count, t * s * s);
    add_slope(i + 1, count, -t * t * s);
  }

 private:
  void add(int point, double share) noexcept { weight[static_cast<std::size_t>(point - first)] += share; }
  void add_slope(int point, int count, double share) noexcept {
    const int middle = std::clamp(point, 1, count - 2);
    // The parabola's slope at its first, middle or last point.
    const double off = point - middle;
    add(middle - 1, share * (off - 0.5));
    add(middle, share * -2.0 * off);
    add(middle + 1, share * (off + 0.5));
  }
};

struct GridWeights {
  struct Term {
    int point;
    double weight;
  };
  std::array<Term, 16> terms;
  int count = 0;
  bool inside = true;

  GridWeights() noexcept = default;
  GridWeights(const LoadGrid& grid, const Eigen::Vector2d& place) noexcept {
    constexpr double negligible = 1e-7;
    const LineWeights a(place[0], grid.counts[0]), b(place[1], grid.counts[1]);
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const double weight = a.weight[static_cast<std::size_t>(i)] * b.weight[static_cast<std::size_t>(j)];
        if (std::abs(weight) < negligible) continue;
        terms[static_cast<std::size_t>(count++)] = {(b.first + j) * grid.counts[0] + a.first + i, weight};
      }
    }
    const double slack = 1e-6;
    for (int i = 0; i < 2; ++i) {
      inside = inside && place[i] >= -slack && place[i] <= grid.counts[static_cast<std::size_t>(i)] - 1 + slack;
    }
  }

  /// Between the four points around a place: for what is small, of which a step in the slope does not show.
  [[nodiscard]] static GridWeights linear(const LoadGrid& grid, const Eigen::Vector2d& place) noexcept {
    GridWeights out;
    std::array<int, 2> low{};
    std::array<double, 2> share{};
    for (std::size_t i = 0; i < 2; ++i) {
      const double x = place[static_cast<Eigen::Index>(i)];
      low[i] = std::clamp(static_cast<int>(std::floor(x)), 0, grid.counts[i] - 2);
      share[i] = std::clamp(x - low[i], 0.0, 1.0);
    }
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const double weight = (i == 0 ? 1.0 - share[0] : share[0]) * (j == 0 ? 1.0 - share[1] : share[1]);
        out.terms[static_cast<std::size_t>(out.count++)] = {(low[1] + j) * grid.counts[0] + low[0] + i, weight};
      }
    }
    return out;
  }

  /// @param value  of a point, as a Result
  template <class Result, class Value>
  [[nodiscard]] Result sum(const Value& value) const noexcept {
    Result out = terms[0].weight * value(terms[0].point);
    for (int k = 1; k < count; ++k) {
      const Term& term = terms[static_cast<std::size_t>(k)];
      out += term.weight * value(term.point);
    }
    return out;
  }
};

}  // namespace touchstone::scene
