#include "fast/response/response_step.h"

#include "fast/realtime/flush_tiny_numbers.h"
#include "fast/realtime/wide_loops.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

namespace touchstone::fast {
namespace {

using scene::GridWeights;
using scene::Vec3;

/// Gauss-Legendre with three points on [0, 1]: exact for the cubic C(p) along the load's way.
constexpr std::array<double, 3> gauss_x{0.1127016653792583, 0.5, 0.8872983346207417};
constexpr std::array<double, 3> gauss_weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
/// With five, where C also depends on the contact's radius.
constexpr std::array<double, 5> gauss5_x{0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415,
                                         0.9530899229693320};
constexpr std::array<double, 5> gauss5_weight{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                              0.2393143352496832, 0.1184634425280945};

double compliance_m_per_n(const ResponseModel& model, const Eigen::Vector2d& place) noexcept {
  return GridWeights(model.response.grid, place).sum<double>([&](int k) { return model.own_compliance[k]; });
}

/// Share of the body's compliance under a contact of this size: its radius is that of Hertz's contact with this force
/// and indentation, 3 F / (4 E* D).
double falloff(const ResponseModel& model, double force_n, double indentation_m) noexcept {
  const double a_m = 0.75 * std::numbers::pi * model.half_space.surface_m2_per_n() * force_n / indentation_m;
  const double a = model.falloff_per_m * a_m;
  return 1.0 / std::sqrt(1.0 + a * a * a * a);
}

LocalContact local_contact(const TipLaw& tip, const GridWeights& weights, double indentation_m) noexcept {
  if (tip.tables.size() == 1) return tip.tables.front().at(indentation_m);
  LocalContact out{.widening = 0.0};
  for (int k = 0; k < weights.count; ++k) {
    const auto [point, weight] = weights.terms[static_cast<std::size_t>(k)];
    const LocalContact one = tip.tables[static_cast<std::size_t>(point)].at(indentation_m);
    out.force_n += weight * one.force_n;
    out.stiffness_n_per_m += weight * one.stiffness_n_per_m;
    out.radius_m += weight * one.radius_m;
    out.flat += weight * one.flat;
    out.widening += weight * one.widening;
    out.peaked += weight * one.peaked;
    out.patch_radius_m += weight * one.patch_radius_m;
  }
  return out;
}

double local_energy_j(const TipLaw& tip, const GridWeights& weights, double indentation_m) noexcept {
  if (tip.tables.size() == 1) return tip.tables.front().energy_j(indentation_m);
  return weights.sum<double>([&](int k) { return tip.tables[static_cast<std::size_t>(k)].energy_j(indentation_m); });
}

/// The forces up to the contact's, by which int_0^F C f df is a sum: of weight C(p(force)), times scale.
struct ForceSteps {
  std::array<double, 2 * gauss5_x.size()> force_n{}, weight{};
  std::size_t count = gauss_x.size();
  double scale = 0.0;
};

ForceSteps force_steps(const ResponseModel& model, const TipLaw& tip, const ResponseContact& contact) noexcept {
  ForceSteps out;
  if (model.falloff_per_m == 0.0) {
    out.scale = contact.law.force_n;
    for (std::size_t q = 0; q < out.count; ++q) {
      out.force_n[q] = gauss_x[q] * out.scale;
      out.weight[q] = gauss_weight[q] * out.force_n[q];
    }
    return out;
  }
  // In u, with f = F u^(3/2), which is nearly the indentation's share under a ball: smooth there. Apart where the
  // contact is small and C falls off.
  constexpr double small = 0.2;
  const double force_n = contact.law.force_n;
  out.count = out.force_n.size();
  out.scale = force_n * force_n;
  for (std::size_t q = 0; q < out.count; ++q) {
    const std::size_t i = q % gauss5_x.size();
    const bool first = q < gauss5_x.size();
    const double size = first ? small : 1.0 - small, u = (first ? 0.0 : small) + size * gauss5_x[i];
    out.force_n[q] = force_n * u * std::sqrt(u);
    double indentation_m = u * contact.indentation_m;
    for (int newton = 0; newton < 2; ++newton) {
      const LocalContact law = local_contact(tip, contact.weights, indentation_m);
      indentation_m =
          std::max(indentation_m - (law.force_n - out.force_n[q]) / law.stiffness_n_per_m, 0.1 * indentation_m);
    }
    out.weight[q] = size * gauss5_weight[i] * 1.5 * u * u * falloff(model, out.force_n[q], indentation_m);
  }
  return out;
}

/// int_0^F C(p(f)) f df.
double body_energy_j(const ResponseModel& model, const LoadPath& path, const ForceSteps& steps) noexcept {
  double sum = 0.0;
  for (std::size_t q = 0; q < steps.count; ++q) {
    sum += steps.weight[q] * compliance_m_per_n(model, path.start + steps.force_n[q] * path.per_n);
  }
  return sum * steps.scale;
}

/// Adds the smooth part of one column, or sets it.
TOUCHSTONE_WIDE_LOOPS
void add_column(const float* column, float weight, Columns3& out_m) noexcept {
  const std::size_t count = out_m[0].size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const from = column + axis * count;
    float* const to = out_m[axis].data();
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
  }
}

/// Four of them, one after the other at each point: the same sums with a quarter of the passes over them.
TOUCHSTONE_WIDE_LOOPS
void add_four_columns(const std::array<const float*, 4>& columns, const std::array<float, 4>& weights,
                      Columns3& out_m) noexcept {
  const std::size_t count = out_m[0].size();
  const auto [w0, w1, w2, w3] = weights;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const a = columns[0] + axis * count;
    const float* const b = columns[1] + axis * count;
    const float* const c = columns[2] + axis * count;
    const float* const d = columns[3] + axis * count;
    float* const to = out_m[axis].data();
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) to[i] = to[i] + w0 * a[i] + w1 * b[i] + w2 * c[i] + w3 * d[i];
  }
}

/// Columns that are added four at a time.
class ColumnSum {
 public:
  explicit ColumnSum(Columns3& out_m) noexcept : out_m_(out_m) {}
  void add(const float* column, float weight) noexcept {
    columns_[count_] = column;
    weights_[count_] = weight;
    if (++count_ < columns_.size()) return;
    add_four_columns(columns_, weights_, out_m_);
    count_ = 0;
  }
  void finish() noexcept {
    for (std::size_t k = 0; k < count_; ++k) add_column(columns_[k], weights_[k], out_m_);
    count_ = 0;
  }

 private:
  Columns3& out_m_;
  std::array<const float*, 4> columns_{};
  std::array<float, 4> weights_{};
  std::size_t count_ = 0;
};

TOUCHSTONE_WIDE_LOOPS
void add(const Columns3& columns, Columns3& out_m) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const from = columns[axis].data();
    float* const to = out_m[axis].data();
    const std::size_t count = columns[axis].size();
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) to[i] += from[i];
  }
}

TOUCHSTONE_WIDE_LOOPS
void hold(const std::vector<float>& free, Columns3& out_m) noexcept {
  for (std::vector<float>& column : out_m) {
    float* const to = column.data();
    const float* const share = free.data();
#pragma GCC ivdep
    for (std::size_t i = 0; i < column.size(); ++i) to[i] *= share[i];
  }
}

Vec3 at(const Columns3& columns, std::int32_t i) noexcept {
  const auto k = static_cast<std::size_t>(i);
  return {columns[0][k], columns[1][k], columns[2][k]};
}

void set(Columns3& columns, std::int32_t i, const Vec3& value) noexcept {
  const auto k = static_cast<std::size_t>(i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns[axis][k] = static_cast<float>(value[static_cast<Eigen::Index>(axis)]);
  }
}

/// Friction of the tick: its part of the load and of the wrench.
/// @returns the contact's displacement on the half space [m]
Vec3 add_friction(const ResponseModel& model, const scene::Pose& pose, ResponseState& state) noexcept {
  ResponseContact& contact = state.contacts.front();
  const scene::ToolTip& tip = model.tips.front().tip;
  const LocalContact& law = contact.law;
  SlipState& slips = *state.slip;
  const Vec3 n = contact.at.normal;
  // It acts as high over the tip's lowest point as the pressure in the mean.
  const double r2_over_a2 = 0.4 + law.flat * (2.0 / 3.0 - 0.4);
  const double height_m = tip.height_m(law.radius_m * std::sqrt(r2_over_a2));
  const Vec3 arm_m = pose.orientation * tip.center_T_m + (height_m - (tip.ball() ? tip.radius_m : 0.0)) * n;
  const scene::Pose before = slips.before;
  slips.before = pose;
  Eigen::Vector2d step_m = Eigen::Vector2d::Zero();
  if (slips.carry(n)) {
    const Vec3 arm_before_m = before.orientation * (pose.orientation.conjugate() * arm_m);
    step_m = slips.frame.transpose() * (pose.position_m + arm_m - before.position_m - arm_before_m);
  }
  const Eigen::Matrix3d C = contact.weights.sum<Eigen::Matrix3d>(
      [&](int k) -> const Eigen::Matrix3d& { return model.shear_compliance[static_cast<std::size_t>(k)]; });
  const Eigen::Matrix2d compliance_m_per_n = slips.frame.transpose() * C * slips.frame;
  const Slip slipped = slip(*model.springs, law, contact.indentation_m, compliance_m_per_n,
                            law.force_n * (slips.frame.transpose() * contact.sway_m_per_n), step_m, slips);
  contact.stretch_m = slips.frame * (slipped.displacement_m + compliance_m_per_n * slipped.force_n);
  contact.friction_n = -(slips.frame * slipped.force_n);
  // Of the two distributions with this moment.
  const Vec3 moment_n = slips.frame * slipped.moment_n_m2 / (law.radius_m * law.radius_m);
  contact.load.punch_shear_n = (moment_n + contact.friction_n / 5.0) / (1.0 / 3.0 - 1.0 / 5.0);
  contact.load.ball_shear_n = -contact.friction_n - contact.load.punch_shear_n;
  contact.wrench.force_n += contact.friction_n;
  contact.wrench.torque_nm += arm_m.cross(contact.friction_n);
  return slips.frame * slipped.displacement_m;
}

/// The ball touches the surface that friction has moved under it, and the pressure's middle leads the tool: all forces
/// turn about the ball's centre.
void turn_about_ball(const ResponseModel& model, const scene::Pose& pose, const Vec3& displacement_m,
                     ResponseContact& contact) noexcept {
  constexpr double lead = 0.085;  // of the contact's displacement; chosen, as in reports/response.md
  // On the scenes compared it is 4 degrees at most. The displacement of a contact that sticks has no bound.
  constexpr double largest_turn_rad = 0.5;
  const scene::ToolTip& tip = model.tips.front().tip;
  const Vec3 n = contact.at.normal;
  scene::Pose behind = pose;
  behind.position_m -= contact.stretch_m;
  const Vec3 moved = scene::touch(*model.body, tip, behind).normal;
  Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(n, moved - lead / tip.radius_m * displacement_m));
  turn.angle() = std::min(turn.angle(), largest_turn_rad);
  const Vec3 center_m = pose.orientation * tip.center_T_m;
  const Vec3 about_center_nm = contact.wrench.torque_nm - center_m.cross(contact.wrench.force_n);
  contact.friction_n = turn * contact.friction_n;
  contact.wrench.force_n = turn * contact.wrench.force_n;
  contact.wrench.torque_nm = turn * about_center_nm + center_m.cross(contact.wrench.force_n);
  contact.lead_m = tip.radius_m * (n - turn * n);
}

/// One of the equal patches of a load along a line; of any other contact its only one.
SpreadLoad patch(const ResponseContact& contact, int k, int patches) noexcept {
  SpreadLoad load = contact.load;
  if (patches == 1) return load;
  load.force_n /= patches;
  load.ball_shear_n /= patches;
  load.center_m += (2.0 * k / (patches - 1) - 1.0) * contact.half_line_m;
  return load;
}

/// Points under the tool lie on it. A point belongs to the contact where it is within the contact's radius, with a
/// little to spare, and the tool is below the free surface there.
void follow_tool(const ResponseModel& model, const scene::ToolTip& tip, const ResponseContact& contact,
                 std::span<const std::int32_t> near, SurfaceField& field) noexcept {
  constexpr double rim = 1.15;  // of the radius: finite strain widens the linear contact
  const Vec3 p0 = contact.at.point_m, n = contact.at.normal;
  const double a_m = contact.law.radius_m, half_m = tip.half_line_T_m.norm();
  // Outward, of depth times slope in the middle; chosen, as in reports/response.md. A ball's is in its field.
  const double slide = tip.round() ? 0.0 : 0.2;
  const Vec3 line = half_m > 0.0 ? contact.half_line_m.normalized() : Vec3::Zero();
  // From the nearest point of the line.
  const auto from_line_m = [&](const Vec3& x_m) -> Vec3 {
    return x_m - std::clamp(x_m.dot(line), -half_m, half_m) * line;
  };
  for (const std::int32_t i : near) {
    if (model.free[static_cast<std::size_t>(i)] == 0.0f) continue;
    const Vec3 d_m = from_line_m(at(model.rest_m, i) - contact.load.center_m);
    const double r_m = (d_m - d_m.dot(n) * n).norm();
    if (r_m > rim * a_m || d_m.dot(n) < -2.0 * a_m) continue;
    Vec3 u_m = at(field.displacement_m, i);
    const Vec3 from_axis_m = from_line_m(at(model.rest_m, i) + u_m - p0);
    Vec3 across_m = from_axis_m - from_axis_m.dot(n) * n;
    const double below_m = -(at(model.rest_m, i) - p0).dot(n);  // of the rest point, under the tangent plane
    const double inward_m = contact.depth_m - tip.height_m(across_m.norm()) - below_m;
    if (r_m > a_m && inward_m <= -u_m.dot(n)) continue;
    const double inside = std::max(1.0 - r_m * r_m / (a_m * a_m), 0.0);
    const double radius_m = across_m.norm();
    Vec3 slid_m = Vec3::Zero();
    if (radius_m > 0.0) {
      slid_m = slide * inward_m * tip.slope(std::min(radius_m, 0.9 * tip.reach_m())) * inside / radius_m * across_m;
    }
    const double new_inward_m = contact.depth_m - tip.height_m((across_m + slid_m).norm()) - below_m;
    u_m += slid_m - (u_m.dot(n) + new_inward_m) * n;
    set(field.displacement_m, i, u_m);
  }
}

/// The rest of a tip's approach to the body, before any force.
void approach(const ResponseModel& model, const TipLaw& tip, ResponseContact& contact) noexcept {
  const scene::LoadGrid& grid = model.response.grid;
  contact.path = {grid.place(contact.at.point_m), Eigen::Vector2d::Zero()};
  const GridWeights& weights = contact.weights = GridWeights(grid, contact.path.start);
  contact.sway_m_per_n = weights.sum<Vec3>([&](int k) -> Vec3 { return model.sway.col(k); });
  contact.tilt_per_n = weights.sum<Vec3>([&](int k) -> Vec3 { return model.tilt.col(k); });
  contact.curvature_per_m =
      weights.sum<double>([&](int k) { return tip.local[static_cast<std::size_t>(k)].curvature_per_m(); });
}

/// Force, load shift and the body's compliance at an indentation, which is at most 0 where the tip does not touch.
void press(const ResponseModel& model, const TipLaw& tip, double indentation_m, ResponseContact& contact) noexcept {
  contact.indentation_m = indentation_m;
  contact.law = local_contact(tip, contact.weights, indentation_m);
  const LocalContact& law = contact.law;
  contact.yielding = 0.0;
  if (!(indentation_m > 0.0)) return;
  // Radius that a ball of the same eccentricity has: of a punch 2 a^2 / (3 D).
  const double radius_m = tip.tip.ball() ? 1.0 / (1.0 / tip.tip.radius_m + contact.curvature_per_m)
                                         : 2.0 * law.radius_m * law.radius_m / (3.0 * indentation_m);
  const scene::LoadGrid& grid = model.response.grid;
  contact.shift_m_per_n = radius_m * contact.tilt_per_n - contact.sway_m_per_n;
  if (!contact.half_line_m.isZero(0.0)) {
    // Along a line the load moves as under a punch with the same second moment.
    const Vec3 along = contact.half_line_m.normalized();
    const double along2_m2 = law.half_line_m * law.half_line_m / 3.0 + law.patch_radius_m * law.patch_radius_m / 5.0;
    contact.shift_m_per_n += (2.0 * along2_m2 / indentation_m - radius_m) * contact.tilt_per_n.dot(along) * along;
  }
  contact.path.per_n = {contact.shift_m_per_n.dot(grid.axes.col(0)) / grid.spacing_m[0],
                        contact.shift_m_per_n.dot(grid.axes.col(1)) / grid.spacing_m[1]};
  contact.compliance_m_per_n = compliance_m_per_n(model, contact.path.start + law.force_n * contact.path.per_n);
  contact.yielding = contact.compliance_m_per_n * law.stiffness_n_per_m;
  if (model.falloff_per_m == 0.0) return;
  const double share = falloff(model, law.force_n, indentation_m), lost = 1.0 - share * share;
  contact.compliance_m_per_n *= share;
  contact.yielding = share * contact.yielding * (1.0 - 2.0 * lost) +
                     2.0 * lost * contact.compliance_m_per_n * law.force_n / indentation_m;
}

/// Newton's method on the indentation of one tip; the law is convex or nearly so, and D itself is never too small a
/// start.
void press_alone(const ResponseModel& model, const TipLaw& tip, double pulled_m, ResponseContact& contact) noexcept {
  double indentation_m = contact.depth_m;
  for (int iteration = 0; iteration < 12; ++iteration) {
    press(model, tip, indentation_m, contact);
    const double open_m = indentation_m + contact.compliance_m_per_n * contact.law.force_n + pulled_m - contact.depth_m;
    const double step_m = open_m / (1.0 + contact.yielding);
    indentation_m = std::max(indentation_m - step_m, 1e-3 * indentation_m);
    if (std::abs(step_m) < 1e-13 * contact.depth_m) break;
  }
  contact.indentation_m = indentation_m;
  contact.law = local_contact(tip, contact.weights, indentation_m);
}

/// C_ij: how far a unit force of one tip lowers the place of another [m/N].
double cross_compliance_m_per_n(const ResponseModel& model, const GridWeights& weights, const Vec3& p_m,
                                const ResponseContact& other) noexcept {
  constexpr double least_m = 1e-6;
  double sum = model.half_space.surface_m2_per_n() / std::max((p_m - other.at.point_m).norm(), least_m);
  for (int j = 0; j < other.weights.count; ++j) {
    const auto [point, weight] = other.weights.terms[static_cast<std::size_t>(j)];
    sum += weight * weights.sum<double>([&, at = point](int k) { return model.cross_compliance(k, at); });
  }
  return sum;
}

/// Tips that touch, or nearly, numbered from 0.
struct Together {
  static constexpr Eigen::Index most = scene::tips_max;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  std::array<std::size_t, scene::tips_max> tip{};
  Eigen::Index count = 0;
};

/// Newton's method on the indentations of all tips together. A tip that does not touch has its gap as a negative
/// indentation and no force, so the equations are the same for all. Starts from tips that are pressed in alone.
void press_together(const ResponseModel& model, const Together& all, double deepest_m, ResponseState& state) noexcept {
  const auto contact = [&](Eigen::Index i) -> ResponseContact& {
    return state.contacts[all.tip[static_cast<std::size_t>(i)]];
  };
  const Eigen::Index n = all.count;
  Together::Square C(n, n), slope(n, n);
  Together::Vector now_m(n), open_m(n), step_m(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    C(i, i) = 0.0;
    now_m[i] = contact(i).indentation_m;
    for (Eigen::Index j = 0; j < i; ++j) {
      C(i, j) = C(j, i) = cross_compliance_m_per_n(model, contact(i).weights, contact(i).at.point_m, contact(j));
    }
  }
  const auto press_all = [&](const Together::Vector& indentation_m) {
    for (Eigen::Index i = 0; i < n; ++i) {
      press(model, model.tips[all.tip[static_cast<std::size_t>(i)]], indentation_m[i], contact(i));
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      open_m[i] = indentation_m[i] + contact(i).compliance_m_per_n * contact(i).law.force_n - contact(i).depth_m;
      for (Eigen::Index j = 0; j < n; ++j) open_m[i] += C(i, j) * contact(j).law.force_n;
    }
    return open_m.cwiseAbs().maxCoeff();
  };
  double off_m = press_all(now_m);
  for (int iteration = 0; iteration < 30; ++iteration) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double stiffness = contact(j).law.stiffness_n_per_m;
      slope.col(j) = stiffness * C.col(j);
      slope(j, j) = 1.0 + contact(j).yielding;
    }
    step_m = slope.partialPivLu().solve(open_m);
    const bool last = step_m.cwiseAbs().maxCoeff() < 1e-14 * deepest_m;
    // A shorter step where a tip comes or goes on the way.
    double share = 1.0;
    Together::Vector next_m = now_m - step_m;
    double next_off_m = press_all(next_m);
    while (!last && next_off_m > off_m && share > 0.02) {
      share *= 0.5;
      next_m = now_m - share * step_m;
      next_off_m = press_all(next_m);
    }
    now_m = next_m;
    off_m = next_off_m;
    if (last) break;
  }
}

/// How the energy of the body's part changes from place to place at these forces, along the surface [N].
Vec3 lateral_n(const ResponseModel& model, const ResponseState& state, const ResponseContact& contact,
               const ForceSteps& steps) noexcept {
  constexpr double e = 0.02;  // steps of the grid
  const scene::LoadGrid& grid = model.response.grid;
  const double force_n = contact.law.force_n;
  Eigen::Vector2d slope_j;  // per step
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    LoadPath low = contact.path, high = contact.path;
    low.start[axis] -= e;
    high.start[axis] += e;
    slope_j[axis] = (body_energy_j(model, high, steps) - body_energy_j(model, low, steps)) / (2.0 * e);
    if (state.contacts.size() == 1) continue;
    const GridWeights below(grid, low.start), above(grid, high.start);
    for (const ResponseContact& other : state.contacts) {
      if (&other == &contact || !other.touches()) continue;
      const Vec3& p_m = contact.at.point_m;
      slope_j[axis] +=
          force_n * other.law.force_n *
          (cross_compliance_m_per_n(model, above, p_m, other) - cross_compliance_m_per_n(model, below, p_m, other)) /
          (2.0 * e);
    }
  }
  Vec3 sum_n = slope_j[0] / grid.spacing_m[0] * grid.axes.col(0) + slope_j[1] / grid.spacing_m[1] * grid.axes.col(1);
  for (const ResponseContact& other : state.contacts) {
    if (&other == &contact || !other.touches()) continue;
    const Vec3 apart_m = contact.at.point_m - other.at.point_m;
    const double distance_m = apart_m.norm();
    sum_n -= force_n * other.law.force_n * model.half_space.surface_m2_per_n() /
             (distance_m * distance_m * distance_m) * apart_m;
  }
  return sum_n - sum_n.dot(contact.at.normal) * contact.at.normal;
}

/// The wrench of a tip that touches without friction, and its part of the energy.
void finish_contact(const ResponseModel& model, const TipLaw& tip, const scene::Pose& pose, ResponseContact& contact,
                    ResponseState& state) noexcept {
  const double force_n = contact.law.force_n;
  const ForceSteps steps = force_steps(model, tip, contact);
  Vec3 along_n = lateral_n(model, state, contact, steps);
  // The foot of a ball moves less than its centre over a round body.
  if (tip.tip.ball()) along_n /= 1.0 + contact.curvature_per_m * (tip.tip.radius_m - contact.depth_m);
  state.energy_j += local_energy_j(tip, contact.weights, contact.indentation_m) + contact.depth_m * force_n -
                    contact.indentation_m * force_n - body_energy_j(model, contact.path, steps);
  for (const ResponseContact& other : state.contacts) {
    if (&other == &contact || !other.touches()) continue;
    state.energy_j -=
        0.5 * force_n * other.law.force_n * cross_compliance_m_per_n(model, contact.weights, contact.at.point_m, other);
  }
  const Vec3 sum_n = force_n * contact.at.normal + along_n;
  const Vec3 center_m = pose.orientation * tip.tip.center_T_m;
  Vec3 arm_m = center_m;
  if (!tip.tip.ball()) arm_m += force_n * contact.shift_m_per_n;
  if (tip.tip.line()) {
    const Vec3 along = contact.half_line_m.normalized();
    arm_m += force_n * contact.shift_m_per_n.dot(along) * along;
  }
  contact.wrench = {sum_n, arm_m.cross(sum_n)};
}

}  // namespace

ContactRange contact_range(const ResponseModel& model, const ResponseState& state, const ResponseContact& contact,
                           const scene::ToolTip& tip) noexcept {
  // Of a line the radius of a disc of its area, and the distance from its end.
  const LocalContact& law = contact.law;
  const double radius_m = std::sqrt(law.radius_m * (law.radius_m + 4.0 / std::numbers::pi * law.half_line_m));
  ContactRange out;
  out.depth_over_radius = contact.depth_m / tip.reach_m();
  out.size_rel = radius_m / model.body_size_m;
  const double edge_m = contact.weights.sum<double>([&](int k) { return model.edge_distance_m[k]; });
  out.edge_over_radius = (edge_m - law.half_line_m) / law.radius_m;
  out.curvature_rel =
      contact.weights.sum<double>([&](int k) { return model.largest_curvature_per_m[k]; }) * tip.reach_m();
  out.apart_over_radii = std::numeric_limits<double>::infinity();
  for (const ResponseContact& other : state.contacts) {
    if (&other == &contact || !other.touches()) continue;
    const double apart_m = (contact.at.point_m - other.at.point_m).norm();
    out.apart_over_radii = std::min(out.apart_over_radii, apart_m / (radius_m + other.law.radius_m));
  }
  return out;
}

StepStatus response_force(const ResponseModel& model, const scene::Pose& given, ResponseState& state) noexcept {
  if (!given.position_m.allFinite() || !given.orientation.coeffs().allFinite() || !(given.orientation.norm() > 1e-6)) {
    return StepStatus::not_finite;
  }
  scene::Pose pose = given;
  pose.orientation.normalize();
  StepStatus status = StepStatus::ok;
  state.wrench = {};
  state.energy_j = 0.0;
  double deepest_m = 0.0;
  for (std::size_t i = 0; i < model.tips.size(); ++i) {
    ResponseContact& contact = state.contacts[i];
    contact = {};
    contact.at = scene::touch(*model.body, model.tips[i].tip, pose);
    contact.depth_m = contact.at.depth_m;
    contact.load.center_m = contact.at.point_m;
    contact.load.normal = contact.at.normal;
    if (model.tips[i].tip.line()) {
      const Vec3 half_m = pose.orientation * model.tips[i].tip.half_line_T_m;
      contact.half_line_m = half_m - half_m.dot(contact.at.normal) * contact.at.normal;
    }
    deepest_m = std::max(deepest_m, contact.depth_m);
  }
  state.lap(Stage::detection);
  if (!(deepest_m > 0.0)) {
    for (ResponseContact& contact : state.contacts) contact.depth_m = 0.0;
    if (state.slip) *state.slip = {};
    return status;
  }
  // The body bulges beside a load by less than this share of the depth.
  constexpr double bulge = 0.25;
  Together together;
  for (std::size_t i = 0; i < model.tips.size(); ++i) {
    ResponseContact& contact = state.contacts[i];
    if (contact.depth_m <= -bulge * deepest_m) continue;
    together.tip[static_cast<std::size_t>(together.count++)] = i;
    approach(model, model.tips[i], contact);
    // Friction sways the surface down or up, as the load sways it sideways: that of the last tick.
    const double pulled_m = state.slip ? contact.sway_m_per_n.dot(state.slip->force_n()) : 0.0;
    if (contact.depth_m > 0.0) {
      press_alone(model, model.tips[i], pulled_m, contact);
    } else {
      press(model, model.tips[i], contact.depth_m, contact);
    }
  }
  if (together.count > 1) {
    state.lap(Stage::force);
    press_together(model, together, deepest_m, state);
    state.lap(Stage::regions);
  }
  for (ResponseContact& contact : state.contacts) {
    const LocalContact& law = contact.law;
    if (!(law.force_n > 0.0)) {
      contact.depth_m = contact.indentation_m = 0.0;
      continue;
    }
    contact.load = {contact.at.point_m, contact.at.normal, law.force_n, law.patch_radius_m,
                    law.flat,           law.widening,      law.peaked};
    const scene::ToolTip& tip = model.tips[static_cast<std::size_t>(&contact - state.contacts.data())].tip;
    if (tip.round()) {
      const double curvature_per_m = 1.0 / tip.radius_m + contact.curvature_per_m;
      contact.load.field = &model.field;
      contact.load.field_m = contact.indentation_m * law.widening * law.radius_m * curvature_per_m;
      contact.load.body_share = contact.curvature_per_m / curvature_per_m;
    }
    if (contact.half_line_m.isZero(0.0)) continue;
    // Equal patches whose places have the mean square of an even line's.
    const double n = model.tips[static_cast<std::size_t>(&contact - state.contacts.data())].patches;
    contact.half_line_m = law.half_line_m * std::sqrt((n - 1.0) / (n + 1.0)) * contact.half_line_m.normalized();
  }
  for (std::size_t i = 0; i < model.tips.size(); ++i) {
    ResponseContact& contact = state.contacts[i];
    if (!contact.touches()) continue;
    const TipLaw& tip = model.tips[i];
    if (contact.at.tilt > scene::tilt_max) status |= StepStatus::tilted;
    const double high_m = tip.tip.ball() ? tip.tip.radius_m : tip.tables.front().largest_indentation_m();
    if (contact.depth_m > high_m) status |= StepStatus::tip_exceeded;
    if (!contact.weights.inside) status |= StepStatus::outside_grid;
    status |= beyond(model.checked, contact_range(model, state, contact, tip.tip));
    finish_contact(model, tip, pose, contact, state);
  }
  state.lap(Stage::force);
  if (state.slip) {
    const Vec3 displacement_m = add_friction(model, pose, state);
    if (model.tips.front().tip.ball()) turn_about_ball(model, pose, displacement_m, state.contacts.front());
    state.lap(Stage::friction);
  }
  for (const ResponseContact& contact : state.contacts) {
    state.wrench.force_n += contact.wrench.force_n;
    state.wrench.torque_nm += contact.wrench.torque_nm;
  }
  const scene::LoadGrid& grid = model.response.grid;
  for (ResponseContact& contact : state.contacts) {
    if (!contact.touches()) continue;
    const Eigen::Vector2d moved = contact.law.force_n * contact.path.per_n;
    const scene::SurfaceQuery loaded = model.body->query(contact.at.point_m - contact.stretch_m + contact.lead_m +
                                                         moved[0] * grid.spacing_m[0] * grid.axes.col(0) +
                                                         moved[1] * grid.spacing_m[1] * grid.axes.col(1));
    contact.load.center_m = loaded.point_m;
    contact.load.normal = loaded.normal;
    if (state.slip) continue;
    // The pressure leans with the surface under the tip.
    constexpr double least_lean = 1e-3;
    const Vec3& force_n = contact.wrench.force_n;
    const Vec3 along_n = force_n - force_n.dot(loaded.normal) * loaded.normal;
    if (along_n.norm() > least_lean * contact.law.force_n) contact.load.ball_shear_n = -along_n;
  }
  return status;
}

void response_shape(const ResponseModel& model, ResponseState& state) noexcept {
  const FlushTinyNumbers flush;
  Columns3& shape_m = state.field.displacement_m;
  const std::size_t vertices = shape_m[0].size();
  const auto near = [&](std::size_t i) {
    return std::span(state.near).subspan(i * vertices, static_cast<std::size_t>(state.near_count[i]));
  };
  bool touches = false;
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const ResponseContact& contact = state.contacts[i];
    if (!contact.touches()) continue;
    std::int32_t* const listed = state.near.data() + i * vertices;
    const int patches = model.tips[i].patches;
    for (int k = 0; k < patches; ++k) {
      const SpreadLoad load = patch(contact, k, patches);
      Columns3& out_m = touches ? state.other_m : shape_m;
      state.near_count[i] = spread_displacements_m(load, model.half_space, model.rest_m, out_m, listed);
      for (const std::int32_t v : near(i)) {
        set(out_m, v, spread_displacement_m(load, model.half_space, at(model.rest_m, v)));
      }
      if (touches) add(out_m, shape_m);
      touches = true;
    }
    if (patches > 1) {
      state.near_count[i] = static_cast<std::int32_t>(vertices);
      std::iota(listed, listed + vertices, 0);
    }
  }
  if (!touches) {
    if (state.deformed) state.field.reset(model.rest_normal);
    state.deformed = false;
    return;
  }
  state.deformed = true;
  const scene::LoadGrid& grid = model.response.grid;
  ColumnSum sum(shape_m);
  for (const ResponseContact& contact : state.contacts) {
    if (!contact.touches()) continue;
    // The body carries the load where the tool is.
    Eigen::VectorXd& weights = state.column_weight;
    weights.setZero();
    const Vec3 moved_m = contact.moved_m();
    const int patches = model.tips[static_cast<std::size_t>(&contact - state.contacts.data())].patches;
    for (int k = 0; k < patches; ++k) {
      const GridWeights one(grid, grid.place(patch(contact, k, patches).center_m + moved_m));
      for (int t = 0; t < one.count; ++t) {
        const auto [point, weight] = one.terms[static_cast<std::size_t>(t)];
        weights[point] += weight / patches;
      }
    }
    const Vec3& force_n = contact.wrench.force_n;
    const Vec3 lateral_n = force_n - force_n.dot(contact.at.normal) * contact.at.normal;
    const auto add_along = [&](int point, double weight) {
      const Eigen::Vector2d along_n = weight * grid.along(point).transpose() * -lateral_n;
      for (int axis = 0; axis < 2; ++axis) {
        sum.add(model.response.smooth_m_per_n.col(model.response.along(point, axis)).data(),
                static_cast<float>(along_n[axis]));
      }
    };
    for (int point = 0; point < grid.count(); ++point) {
      if (weights[point] == 0.0) continue;
      sum.add(model.response.smooth_m_per_n.col(point).data(),
              static_cast<float>(weights[point] * contact.load.force_n));
      if (state.slip) add_along(point, weights[point]);
    }
    if (contact.load.field != nullptr) {
      const auto apart_nm = static_cast<float>(model.half_space.double_force_nm(contact.load.apart_m3()));
      const GridWeights four = GridWeights::linear(grid, grid.place(contact.load.center_m + moved_m));
      for (int t = 0; t < four.count; ++t) {
        const auto [point, weight] = four.terms[static_cast<std::size_t>(t)];
        sum.add(model.response.smooth_m_per_n.col(model.response.apart(point)).data(),
                static_cast<float>(weight) * apart_nm);
      }
    }
    // Without friction there is little of it: the columns of the middle will do.
    if (!state.slip && !contact.load.shear_n().isZero(0.0)) add_along(grid.middle(), 1.0);
  }
  sum.finish();
  hold(model.free, shape_m);
  state.lap(Stage::interpolation);
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    if (state.contacts[i].touches()) follow_tool(model, model.tips[i].tip, state.contacts[i], near(i), state.field);
  }
  state.lap(Stage::local_factor);
  update_normals(model.normals, state.field);
  state.lap(Stage::normals);
}

StepStatus response_step(const ResponseModel& model, const scene::Pose& pose, ResponseState& state) noexcept {
  const StepStatus status = response_force(model, pose, state);
  if (status != StepStatus::not_finite) response_shape(model, state);
  return status;
}

}  // namespace touchstone::fast
