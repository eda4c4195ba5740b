#include "reference/verification/pressed_with_friction.h"

#include <Eigen/Dense>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace touchstone::verification {
namespace {

/// Complete elliptic integrals of the parameter m = k^2.
double K_of(double m) { return std::comp_ellint_1(std::sqrt(m)); }
double E_of(double m) { return std::comp_ellint_2(std::sqrt(m)); }

/// N of a unit pressure on the disc r < e: Johnson, 3.29.
double settlement_of_disc(double e, double r) {
  if (e <= 0.0) return 0.0;
  if (r < e) return M_2_PI * e * E_of(r * r / (e * e));
  const double m = e * e / (r * r);
  return M_2_PI * r * (E_of(m) - (1.0 - m) * K_of(m));
}

/// T of the shear q = r on the disc r < e, e^2 int_0^inf J_2(e x) J_1(r x) / x dx: Weber's and Schafheitlin's integral.
double spread_of_disc(double e, double r) {
  if (e <= 0.0) return 0.0;
  if (r < e) {
    const double m = r * r / (e * e);
    return e * e * 2.0 / (3.0 * M_PI) * ((2.0 * m - 1.0) * E_of(m) + (1.0 - m) * K_of(m)) / std::sqrt(m);
  }
  const double m = e * e / (r * r);
  return r * r * 2.0 / (3.0 * M_PI) * ((2.0 - m) * E_of(m) - 2.0 * (1.0 - m) * K_of(m));
}

/// The punch with a given stick radius.
class Rings {
 public:
  Rings(double stick_radius, int rings) : sticking_(2 * rings) {
    const double c = stick_radius;
    // Two halves inside c, finer towards c; two outside, finer towards c and the rim.
    constexpr double finest = 1e-5;
    const double ratio = std::pow(finest, 1.0 / (rings - 1));
    const auto finer_down = [&](double from, double width) {  // from + width * 1, ratio, ratio^2, ..., 0
      std::vector<double> edges{from};
      for (int k = rings - 1; k >= 0; --k) edges.push_back(from + width * std::pow(ratio, k));
      return edges;
    };
    const std::vector<double> up = finer_down(c, 0.5 * (1.0 - c)), down = finer_down(0.0, 0.5 * (1.0 - c));
    for (int k = 0; k <= rings; ++k) edges_.push_back(0.5 * c * k / rings);
    const std::vector<double> inner = finer_down(0.0, 0.5 * c);
    for (int k = rings - 1; k >= 0; --k) edges_.push_back(c - inner[k]);
    edges_.insert(edges_.end(), up.begin() + 1, up.end());
    for (int k = rings - 1; k >= 0; --k) edges_.push_back(1.0 - down[k]);
    const int count = static_cast<int>(edges_.size()) - 1;
    N_.resize(count, count);
    T_.resize(count, count);
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < count; ++k) {
        N_(i, k) = settlement(k, middle(i));
        T_(i, k) = spread_of_disc(edges_[k + 1], middle(i)) - spread_of_disc(edges_[k], middle(i));
      }
    }
  }

  [[nodiscard]] double middle(int k) const { return 0.5 * (edges_[k] + edges_[k + 1]); }
  [[nodiscard]] double settlement(int ring, double r) const {
    return settlement_of_disc(edges_[ring + 1], r) - settlement_of_disc(edges_[ring], r);
  }

  /// Solves for the pressure of every ring. @returns the shear's step at c over mu p there
  double solve(double g, double friction) {
    const int count = static_cast<int>(N_.rows());
    // Unknowns: p of every ring, then q / r of the sticking ones.
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count + sticking_, count + sticking_);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(count + sticking_);
    for (int i = 0; i < count; ++i) {
      A.row(i).head(count) = N_.row(i);
      b[i] = 1.0;
      const double r = middle(i);
      const auto add_shear = [&](int row, int ring, double weight) {
        if (ring < sticking_) {
          A(row, count + ring) += weight;
        } else {
          A(row, ring) += weight * friction / middle(ring);
        }
      };
      for (int k = i; k < count; ++k) {
        const double from = std::max(edges_[k], r), to = edges_[k + 1];
        add_shear(i, k, -0.5 * g * (to * to - from * from));
      }
      if (i >= sticking_) continue;
      for (int k = 0; k < count; ++k) add_shear(count + i, k, T_(i, k));
      for (int k = 0; k <= i; ++k) {
        const double from = edges_[k], to = std::min(edges_[k + 1], r);
        A(count + i, k) -= 0.5 * g * (to * to - from * from) / r;
      }
    }
    const Eigen::VectorXd x = A.partialPivLu().solve(b);
    p_ = x.head(count);
    // Nearer to c the rings' errors are larger than the shear's step.
    int at = sticking_ - 1;
    while (at > 0 && edges_[sticking_] - middle(at) < 5e-5 * edges_[sticking_]) --at;
    return x[count + at] * middle(at) / (friction * p_[at]) - 1.0;
  }

  [[nodiscard]] double force() const {
    double sum = 0.0;
    for (int k = 0; k < p_.size(); ++k) sum += M_PI * p_[k] * (edges_[k + 1] * edges_[k + 1] - edges_[k] * edges_[k]);
    return sum;
  }
  /// Of the surface outside.
  [[nodiscard]] double settlement(double r) const {
    double sum = 0.0;
    for (int k = 0; k < p_.size(); ++k) sum += p_[k] * settlement(k, r);
    return sum;
  }

 private:
  int sticking_;
  std::vector<double> edges_;
  Eigen::MatrixXd N_, T_;
  Eigen::VectorXd p_;
};

}  // namespace

PressedWithFriction pressed_with_friction(double poissons_ratio, double friction, int rings) {
  if (!(friction > 0.0)) throw std::domain_error("pressed_with_friction: friction must be above 0");
  const double g = (1.0 - 2.0 * poissons_ratio) / (2.0 * (1.0 - poissons_ratio));
  PressedWithFriction answer;
  if (g == 0.0) return answer;  // nothing moves along the surface
  // The shear just inside is below friction for too small a stick radius, and above for too large a one.
  const auto step_at = [&](double stick_radius) { return Rings(stick_radius, rings).solve(g, friction); };
  double low = 0.1, high = 0.998;
  if (!(step_at(low) < 0.0 && step_at(high) > 0.0)) {
    throw std::domain_error("pressed_with_friction: the stick radius is not between 0.1 and 0.998");
  }
  for (int k = 0; k < 18; ++k) {
    const double middle = 0.5 * (low + high);
    (step_at(middle) < 0.0 ? low : high) = middle;
  }
  answer.stick_radius = 0.5 * (low + high);
  Rings punch(answer.stick_radius, rings);
  punch.solve(g, friction);
  answer.punch_stiffness = punch.force() / 4.0;
  // The ball: d' = k a with k R (1 - 2 int_0^1 w(1 / t) t dt) = 1, where w is the surface outside the punch; t = sin s.
  double outside = 0.0;
  constexpr int intervals = 100;
  for (int k = 1; k < intervals; ++k) {
    const double s = M_PI_2 * k / intervals, t = std::sin(s);
    outside += M_PI_2 / intervals / 3.0 * (k % 2 == 1 ? 4.0 : 2.0) * punch.settlement(1.0 / t) * t * std::cos(s);
  }
  answer.ball_depth = 0.5 / (1.0 - 2.0 * outside);
  answer.ball_force = answer.punch_stiffness / std::sqrt(answer.ball_depth);
  return answer;
}

}  // namespace touchstone::verification
