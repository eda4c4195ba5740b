#include "reference/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::reference {

double FrictionLaw::coefficient(double normal_n, bool sliding) const noexcept {
  const double at_rest = friction_.K * std::pow(normal_n, friction_.beta - 1.0);
  return sliding ? std::min(friction_.mu_D, at_rest) : at_rest;
}

int solve_with_slip(const SlipCoupling& slip, const std::function<void(Eigen::VectorXd&)>& solve_symmetric,
                    Eigen::VectorXd& x) {
  // Newton's method wants no more than a few digits of the normal forces.
  constexpr double tolerance = 1e-7;
  constexpr int most_steps = 60;
  using Vector = Eigen::VectorXd;
  int solutions = 0;
  const auto inverse = [&](Vector b) {
    solve_symmetric(b);
    ++solutions;
    return b;
  };
  const Vector b = x;
  // The start's remainder is right - guess - row K^-1 (column guess), with one solution for both parts.
  Vector y = slip.guess_n;
  Vector remainder = slip.normal_n + slip.row * inverse(b - slip.column * y) - y;
  const double enough = tolerance * std::max(y.norm(), remainder.norm());
  std::vector<Vector> directions, images;
  for (int step = 0; step < most_steps && remainder.norm() > enough; ++step) {
    Vector direction = remainder;
    Vector image = direction + slip.row * inverse(slip.column * direction);
    for (std::size_t k = 0; k < images.size(); ++k) {
      const double share = images[k].dot(image);
      image -= share * images[k];
      direction -= share * directions[k];
    }
    const double length = image.norm();
    if (!(length > 0.0)) break;
    directions.push_back(direction / length);
    images.push_back(image / length);
    const double share = images.back().dot(remainder);
    y += share * directions.back();
    remainder -= share * images.back();
  }
  x = inverse(b - slip.column * y);
  return solutions;
}

}  // namespace touchstone::reference
