#include "fast/response/contact_table.h"

#include "fast/response/line_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

constexpr int nodes = 257;
constexpr int line_nodes = 33;

/// Gauss-Legendre on [0, 1].
struct Rule {
  static constexpr int size = 48;
  std::array<double, size> x{}, weight{};
  Rule() {
    for (int i = 0; i < size; ++i) {
      double z = std::cos(std::numbers::pi * (i + 0.75) / (size + 0.5)), slope = 1.0;
      for (int iteration = 0; iteration < 50; ++iteration) {
        double p1 = 1.0, p2 = 0.0;
        for (int j = 0; j < size; ++j) {
          const double p3 = p2;
          p2 = p1;
          p1 = ((2.0 * j + 1.0) * z * p2 - j * p3) / (j + 1.0);
        }
        slope = size * (z * p1 - p2) / (z * z - 1.0);
        const double step = p1 / slope;
        z -= step;
        if (std::abs(step) < 1e-15) break;
      }
      x[static_cast<std::size_t>(i)] = 0.5 * (1.0 - z);
      weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - z * z) * slope * slope);
    }
  }
};

/// Gap of tool and body, both at rest.
struct Gap {
  const scene::ToolTip& tip;
  const LocalShape& local;
  [[nodiscard]] double height_m(double r_m) const { return tip.height_m(r_m) + local.height_m(r_m); }
  [[nodiscard]] double slope(double r_m) const { return tip.slope(r_m) + local.slope(r_m); }
};

/// D(t). The integral over r = t sin(theta) runs in pi/2 - theta = end s^3, close nodes where the tip gets steep.
double indentation_m(const Gap& gap, double t_m, const Rule& rule) {
  const auto integral = [&](double first, double last, const auto& slope) {  // over pi/2 - theta
    double sum = 0.0;
    for (std::size_t i = 0; i < Rule::size; ++i) {
      const double s = rule.x[i], angle = first + (last - first) * s * s * s;
      sum += rule.weight[i] * 3.0 * s * s * slope(t_m * std::cos(angle));
    }
    return t_m * (last - first) * sum;
  };
  const double all = 0.5 * std::numbers::pi;
  const double rim = t_m > gap.tip.flat_radius_m ? std::acos(gap.tip.flat_radius_m / t_m) : 0.0;
  return integral(0.0, rim, [&](double r_m) { return gap.tip.slope(r_m); }) +
         integral(0.0, all, [&](double r_m) { return gap.local.slope(r_m); });
}

/// Mean depth over the radius of the overlap that the surfaces at rest have when they are moved into each other.
double overlap_ratio(const Gap& gap, double depth_m) {
  double low_m = 0.0, high_m = gap.tip.reach_m();
  if (gap.height_m(high_m) > depth_m) {
    for (int k = 0; k < 60; ++k) {
      const double middle_m = 0.5 * (low_m + high_m);
      (gap.height_m(middle_m) < depth_m ? low_m : high_m) = middle_m;
    }
  }
  const double radius_m = high_m;
  constexpr int steps = 200;
  double volume = 0.0;  // over pi
  for (int k = 0; k < steps; ++k) {
    const double r_m = radius_m * (k + 0.5) / steps;
    volume += (depth_m - gap.height_m(r_m)) * 2.0 * r_m * radius_m / steps;
  }
  return volume / (radius_m * radius_m * radius_m);
}

}  // namespace

LocalShape local_shape(const scene::Shape& body, const scene::Vec3& point_m, const scene::Vec3& normal,
                       double reach_m) {
  const int face = body.face_of(body.query(point_m).patch);
  const scene::Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  // Means over circles, as far as all of a circle lies on the face.
  constexpr int circles = 8, directions = 16;
  Eigen::Matrix2d normal_matrix = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int c = 1; c <= circles; ++c) {
    const double r_m = reach_m * c / circles;
    double mean_m = 0.0;
    bool whole = true;
    for (int d = 0; d < directions && whole; ++d) {
      const double angle = 2.0 * std::numbers::pi * d / directions;
      const scene::Vec3 above_m = point_m + r_m * (std::cos(angle) * first + std::sin(angle) * second);
      const scene::Crossing crossing = body.crossing(above_m + reach_m * normal, above_m - 2.0 * reach_m * normal);
      whole = !crossing.empty() && crossing.enter_m > 0.0 &&
              body.face_of(body.query(above_m + (reach_m - crossing.enter_m) * normal).patch) == face;
      if (whole) mean_m += (crossing.enter_m - reach_m) / directions;
    }
    if (!whole) break;
    // In units of the reach, so that the system is well posed.
    const double x = static_cast<double>(c) / circles;
    const Eigen::Vector2d powers(x * x, x * x * x * x);
    normal_matrix += powers * powers.transpose();
    right += powers * (mean_m / reach_m);
  }
  if (normal_matrix.determinant() < 1e-12) return {};
  const Eigen::Vector2d h = normal_matrix.ldlt().solve(right);
  return {h[0] / reach_m, h[1] / (reach_m * reach_m * reach_m)};
}

ContactTable::ContactTable(const scene::ToolTip& tip, const LocalShape& local, double E_star_pa,
                           const FiniteStrain& strain) {
  if (tip.line()) {
    tabulate_line(tip, E_star_pa, strain);
    return;
  }
  const Gap gap{tip, local};
  const Rule rule;
  // Radii, closer where the contact is small.
  constexpr int radii = 4000;
  constexpr double last_share = 0.999;  // of the ball or the fillet: at its end the slope is unbounded
  struct At {
    double a_m, D_m, sum_m2, moment_m4;  // int_0^a (D(a) - D) dt, int_0^a t^2 (D(a) - D) dt
  };
  std::vector<At> curve{{tip.flat_radius_m, 0.0, 0.0, 0.0}};
  double below_m2 = 0.0, below_m4 = 0.0;  // int D dt, int t^2 D dt
  const double inner_m = tip.flat_radius_m, outer_m = inner_m + last_share * tip.radius_m;
  for (int k = 1; k <= radii; ++k) {
    const double share = static_cast<double>(k) / radii, a_m = inner_m + (outer_m - inner_m) * share * share;
    const double D_m = indentation_m(gap, a_m, rule);
    const At& last = curve.back();
    below_m2 += 0.5 * (D_m + last.D_m) * (a_m - last.a_m);
    below_m4 += 0.5 * (D_m * a_m * a_m + last.D_m * last.a_m * last.a_m) * (a_m - last.a_m);
    curve.push_back({a_m, D_m, a_m * D_m - below_m2, a_m * a_m * a_m * D_m / 3.0 - below_m4});
  }
  if (!tip.ball()) {
    constexpr std::size_t every = 10;
    for (std::size_t k = 0; k < curve.size(); k += every) rim_.push_back({curve[k].a_m, curve[k].D_m});
  }
  largest_m_ = std::max(curve.back().D_m, 2.0 * tip.reach_m());
  step_ = std::sqrt(largest_m_) / (nodes - 1);
  std::size_t k = 0;
  for (int i = 0; i < nodes; ++i) {
    const double s = step_ * i, D_m = s * s;
    while (k + 2 < curve.size() && curve[k + 1].D_m < D_m) ++k;
    At at = curve.back();
    double dx_dD = 0.0;
    if (D_m >= at.D_m) {  // on the tip's whole reach, a punch
      at.sum_m2 += at.a_m * (D_m - at.D_m);
      at.moment_m4 += at.a_m * at.a_m * at.a_m * (D_m - at.D_m) / 3.0;
    } else {
      const At &low = curve[k], &high = curve[k + 1];
      // d(sum)/dD = a: between two radii by the mean of a.
      const double share = (D_m - low.D_m) / (high.D_m - low.D_m);
      at.a_m = low.a_m + share * (high.a_m - low.a_m);
      at.sum_m2 = low.sum_m2 + 0.5 * (low.a_m + at.a_m) * (D_m - low.D_m);
      at.moment_m4 = low.moment_m4 + share * (high.moment_m4 - low.moment_m4);
    }
    const double x = i > 0 ? overlap_ratio(gap, D_m) : 0.0;
    if (i > 0) {
      const double e_m = 1e-3 * D_m;
      dx_dD = (overlap_ratio(gap, D_m + e_m) - overlap_ratio(gap, D_m - e_m)) / (2.0 * e_m);
    }
    const double linear_n = 2.0 * E_star_pa * at.sum_m2, factor = strain.factor(x);
    const double dF_dD = 2.0 * E_star_pa * at.a_m * factor - linear_n * (strain.c1 + 2.0 * strain.c2 * x) * dx_dD;
    const double moment_m2 = i > 0 ? at.moment_m4 / at.sum_m2 : 0.0, a2_m2 = at.a_m * at.a_m;
    const double flat = a2_m2 > 0.0 ? (moment_m2 / a2_m2 - 1.0 / 5.0) / (1.0 / 3.0 - 1.0 / 5.0) : 0.0;
    const double widening = tip.ball() ? strain.widening(x) : 1.0, between = std::clamp(flat, 0.0, 1.0);
    // 3/2 + peaked is the pressure in the middle over its mean.
    const double peaked = tip.ball() ? strain.peak(x) * widening * widening - 1.5 : 0.0;
    nodes_.push_back({linear_n * factor, dF_dD * 2.0 * s, at.a_m, between, widening, peaked, 0.0, at.a_m, 0.0});
  }
  if (tip.flat_radius_m > 0.0) nodes_[0].flat = 1.0;
  for (std::size_t i = 1; i < nodes_.size(); ++i) nodes_[i].energy_j = energy_j(i - 1, 1.0);
}

void ContactTable::tabulate_line(const scene::ToolTip& tip, double E_star_pa, const FiniteStrain& strain) {
  const double R = tip.radius_m, half_m = tip.half_line_T_m.norm();
  largest_m_ = radius_m_ = R;
  line_m_ = half_m;
  step_ = std::sqrt(largest_m_) / (line_nodes - 1);
  nodes_.emplace_back().half_line_m = half_m;
  for (int i = 1; i < line_nodes; ++i) {
    const double D_m = std::min(step_ * i * step_ * i, largest_m_);
    const LineContact line = line_contact(R, half_m, D_m, E_star_pa);
    // The overlap of the surfaces at rest: two half balls and what is between them.
    const double wide_m = std::sqrt(D_m * (2.0 * R - D_m)), ball_m2 = std::numbers::pi * wide_m * wide_m;
    const double area_m2 = ball_m2 + 4.0 * half_m * wide_m;
    const double volume_m3 = std::numbers::pi * D_m * D_m * (3.0 * R - D_m) / 3.0 +
                             2.0 * half_m * (R * R * std::acos(1.0 - D_m / R) - (R - D_m) * wide_m);
    const double x = volume_m3 / (area_m2 * std::sqrt(area_m2 / std::numbers::pi));
    const double length2_m2 = std::max(3.0 * (line.along2_m2 - line.across2_m2), 0.0);
    pressure_rel_.insert(pressure_rel_.end(), line.pressure_rel.begin(), line.pressure_rel.end());
    Node& node = nodes_.emplace_back();
    node.force_n = line.force_n * strain.factor(x);
    node.radius_m = line.half_width_m;
    node.patch_radius_m = std::sqrt(5.0 * line.across2_m2);
    node.half_line_m = std::sqrt(length2_m2);
  }
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    const std::size_t next = std::min(i + 1, nodes_.size() - 1);
    nodes_[i].slope = (nodes_[next].force_n - nodes_[i - 1].force_n) / (step_ * static_cast<double>(next - i + 1));
  }
  for (std::size_t i = 1; i < nodes_.size(); ++i) nodes_[i].energy_j = energy_j(i - 1, 1.0);
}

ContactTable::Place ContactTable::place(double s) const noexcept {
  const double steps = s / step_;
  const auto i = static_cast<std::size_t>(std::min(static_cast<int>(steps), static_cast<int>(nodes_.size()) - 2));
  return {i, steps - static_cast<double>(i)};
}

LocalContact ContactTable::at(double indentation_m) const noexcept {
  if (!(indentation_m > 0.0)) return {};
  const double s = std::sqrt(std::min(indentation_m, largest_m_));
  const auto [i, t] = place(s);
  const Node &low = nodes_[i], &high = nodes_[i + 1];
  const double rise = high.force_n - low.force_n, m0 = step_ * low.slope, m1 = step_ * high.slope;
  const double c2 = 3.0 * rise - 2.0 * m0 - m1, c3 = m0 + m1 - 2.0 * rise;
  LocalContact out;
  out.force_n = low.force_n + t * (m0 + t * (c2 + t * c3));
  out.stiffness_n_per_m = (m0 + t * (2.0 * c2 + 3.0 * t * c3)) / (step_ * 2.0 * s);
  out.radius_m = low.radius_m + t * (high.radius_m - low.radius_m);
  out.flat = low.flat + t * (high.flat - low.flat);
  out.widening = low.widening + t * (high.widening - low.widening);
  out.peaked = low.peaked + t * (high.peaked - low.peaked);
  out.patch_radius_m = low.patch_radius_m + t * (high.patch_radius_m - low.patch_radius_m);
  out.half_line_m = low.half_line_m + t * (high.half_line_m - low.half_line_m);
  return out;
}

double ContactTable::disc_pressure_per_m2(double indentation_m, double r_m) const noexcept {
  const double D_m = indentation_m;
  double integral = 0.0, sum_m2 = D_m * rim_.front().t_m,
         a_m = rim_.front().t_m;  // int dD / sqrt(t^2 - r^2); int_0^a (D - D(t)) dt
  const auto upper = [&](double t_m) { return t_m + std::sqrt(std::max(t_m * t_m - r_m * r_m, 0.0)); };
  for (std::size_t k = 0; k + 1 < rim_.size() && rim_[k].D_m < D_m; ++k) {
    const auto [low_m, low_D_m] = rim_[k];
    const double slope = (rim_[k + 1].D_m - low_D_m) / (rim_[k + 1].t_m - low_m);
    a_m = std::min(rim_[k + 1].t_m, low_m + (D_m - low_D_m) / slope);
    sum_m2 += (D_m - low_D_m - 0.5 * slope * (a_m - low_m)) * (a_m - low_m);
    if (a_m > r_m) integral += slope * std::log(upper(a_m) / upper(std::max(low_m, r_m)));
  }
  // Deeper than the rim is high it is a punch.
  if (D_m > rim_.back().D_m && r_m < a_m) integral += (D_m - rim_.back().D_m) / std::sqrt(a_m * a_m - r_m * r_m);
  return integral / (2.0 * std::numbers::pi * sum_m2);
}

double ContactTable::pressure_per_m2(double indentation_m, double across_m, double along_m) const noexcept {
  if (!(indentation_m > 0.0)) return 0.0;
  if (!rim_.empty()) return disc_pressure_per_m2(indentation_m, across_m);
  constexpr int across = line_cells_across, along = line_cells_along;
  const double D_m = std::min(indentation_m, largest_m_);
  // In cells of the overlap at rest of this depth, from the middle of the first.
  const double wide_m = std::sqrt(D_m * (2.0 * radius_m_ - D_m)), long_m = line_m_ + wide_m;
  const double x = std::max(std::abs(across_m) / wide_m * across - 0.5, 0.0);
  const double y = std::max(std::abs(along_m) / long_m * along - 0.5, 0.0);
  if (!(x < across && y < along)) return 0.0;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  const auto [node, share] = place(std::sqrt(D_m));
  const auto at_node = [&](std::size_t n) {
    const float* const cells = pressure_rel_.data() + (std::max<std::size_t>(n, 1) - 1) * across * along;
    const auto cell = [&](int p, int q) {
      return p < across && q < along ? static_cast<double>(cells[p * along + q]) : 0.0;
    };
    return (1.0 - u) * ((1.0 - v) * cell(i, j) + v * cell(i, j + 1)) +
           u * ((1.0 - v) * cell(i + 1, j) + v * cell(i + 1, j + 1));
  };
  return (at_node(node) + share * (at_node(node + 1) - at_node(node))) / (4.0 * wide_m * long_m);
}

double ContactTable::largest_pressure_per_m2(double indentation_m) const noexcept {
  constexpr int steps = 200;
  const double a_m = at(indentation_m).radius_m;
  double largest = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double share = (k + 0.5) / steps;
    // Under a disc close together towards the edge.
    largest = std::max(largest, rim_.empty() ? pressure_per_m2(indentation_m, 0.0, share * (line_m_ + radius_m_))
                                             : pressure_per_m2(indentation_m, a_m * share * (2.0 - share), 0.0));
  }
  return largest;
}

double ContactTable::energy_j(double indentation_m) const noexcept {
  if (!(indentation_m > 0.0)) return 0.0;
  const auto [i, t] = place(std::sqrt(std::min(indentation_m, largest_m_)));
  return energy_j(i, t);
}

double ContactTable::energy_j(std::size_t i, double t) const noexcept {
  const Node &low = nodes_[i], &high = nodes_[i + 1];
  const double rise = high.force_n - low.force_n, m0 = step_ * low.slope, m1 = step_ * high.slope;
  const double c2 = 3.0 * rise - 2.0 * m0 - m1, c3 = m0 + m1 - 2.0 * rise, f0 = low.force_n;
  // int F 2 s ds with s = step (i + t), of the cubic F.
  const double zeroth = t * (f0 + t * (m0 / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0)));
  const double first = t * t * (f0 / 2.0 + t * (m0 / 3.0 + t * (c2 / 4.0 + t * c3 / 5.0)));
  return low.energy_j + 2.0 * step_ * step_ * (static_cast<double>(i) * zeroth + first);
}

}  // namespace touchstone::fast
