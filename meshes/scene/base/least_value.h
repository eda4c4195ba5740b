// The least value of a convex function over a convex region of few dimensions.
#pragma once

#include "scene/base/frames.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {

/// A convex function's value at a place, with a subgradient.
template <int N>
struct Sample {
  double value;
  Eigen::Matrix<double, N, 1> gradient;
};

/// A place relative to the searched region: the nearest place of the region, its distance, and the direction
/// from it; off_m <= 0 in the region.
template <int N>
struct Reach {
  double off_m;
  Eigen::Matrix<double, N, 1> nearest, normal;
};

/// Least value of a convex function over a convex region, by cuts through a shrinking ellipsoid that holds it
/// (deep cuts, Bland, Goldfarb and Todd 1981): it needs no smoothness and gives a lower bound to stop by.
/// @param radius_m of a ball about `center` that holds the region
/// @param enough a lower bound that ends the search: nothing below matters
template <int N, class Function, class Region>
double least_value(Eigen::Matrix<double, N, 1> center, double radius_m, double tolerance_m, double enough,
                   const Function& function, const Region& region) {
  using Place = Eigen::Matrix<double, N, 1>;
  Eigen::Matrix<double, N, N> P = radius_m * radius_m * Eigen::Matrix<double, N, N>::Identity();
  double best = INFINITY, bound = -INFINITY;
  for (int iteration = 0; iteration < 2000; ++iteration) {
    const Sample<N> here = function(center);
    const Reach<N> reach = region(center);
    const bool feasible = reach.off_m <= 0.0;
    best = std::min(best, feasible ? here.value : function(reach.nearest).value);
    // A convex function lies above its tangent, in the whole ellipsoid.
    bound = std::max(bound, here.value - std::sqrt(std::max(0.0, here.gradient.dot(P * here.gradient))));
    if (best - bound <= tolerance_m || bound >= enough) break;
    const Place cut = feasible ? here.gradient : reach.normal;
    const double width = std::sqrt(std::max(0.0, cut.dot(P * cut)));
    const double depth = (feasible ? here.value - best : reach.off_m) / width;
    // Nothing of the region is left that could be better.
    if (!(depth < 1.0)) break;
    const Place step = P * cut / width;
    constexpr double n = N;
    center -= (1.0 + n * depth) / (n + 1.0) * step;
    P -= 2.0 * (1.0 + n * depth) / ((n + 1.0) * (1.0 + depth)) * step * step.transpose();
    P *= n * n * (1.0 - depth * depth) / (n * n - 1.0);
    P = (0.5 * (P + P.transpose())).eval();
  }
  return best;
}

}  // namespace touchstone::scene
