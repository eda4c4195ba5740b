#include "fast/response/response_step.h"

#include "fast/realtime/flush_tiny_numbers.h"
#include "fast/realtime/wide_loops.h"
#include "fast/response/grid_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Gauss-Legendre with three points on [0, 1]: exact for the cubic C(p) along the load's way.
constexpr std::array<double, 3> gauss_x{0.1127016653792583, 0.5, 0.8872983346207417};
constexpr std::array<double, 3> gauss_weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

/// How the load moves with the force, in the grid's coordinates.
struct LoadPath {
  Eigen::Vector2d start;  ///< at no force, in steps
  Eigen::Vector2d per_n;  ///< steps per newton
};

double compliance_m_per_n(const ResponseModel& model, const Eigen::Vector2d& place) noexcept {
  return GridWeights(model.response.grid, place).sum<double>([&](int k) { return model.own_compliance[k]; });
}

/// int_0^F C(p(f)) f df.
double body_energy_j(const ResponseModel& model, const LoadPath& path, double force_n) noexcept {
  double sum = 0.0;
  for (std::size_t q = 0; q < gauss_x.size(); ++q) {
    const double f_n = gauss_x[q] * force_n;
    sum += gauss_weight[q] * f_n * compliance_m_per_n(model, path.start + f_n * path.per_n);
  }
  return sum * force_n;
}

LocalContact local_contact(const ResponseModel& model, const GridWeights& weights, double indentation_m) noexcept {
  if (model.tables.size() == 1) return model.tables.front().at(indentation_m);
  LocalContact out{.widening = 0.0};
  for (int k = 0; k < weights.count; ++k) {
    const auto [point, weight] = weights.terms[static_cast<std::size_t>(k)];
    const LocalContact one = model.tables[static_cast<std::size_t>(point)].at(indentation_m);
    out.force_n += weight * one.force_n;
    out.stiffness_n_per_m += weight * one.stiffness_n_per_m;
    out.radius_m += weight * one.radius_m;
    out.flat += weight * one.flat;
    out.widening += weight * one.widening;
    out.peaked += weight * one.peaked;
  }
  return out;
}

double local_energy_j(const ResponseModel& model, const GridWeights& weights, double indentation_m) noexcept {
  if (model.tables.size() == 1) return model.tables.front().energy_j(indentation_m);
  return weights.sum<double>([&](int k) { return model.tables[static_cast<std::size_t>(k)].energy_j(indentation_m); });
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
void add_friction(const ResponseModel& model, const scene::Pose& pose, const GridWeights& weights,
                  const LocalContact& law, const Vec3& sway_m_per_n, ResponseState& state) noexcept {
  ResponseContact& contact = state.contact;
  SlipState& slips = *state.slip;
  const Vec3 n = contact.at.normal;
  // It acts as high over the tip's lowest point as the pressure in the mean.
  const double r2_over_a2 = 0.4 + law.flat * (2.0 / 3.0 - 0.4);
  const double height_m = model.tip.height_m(law.radius_m * std::sqrt(r2_over_a2));
  const Vec3 arm_m =
      pose.orientation * model.tip.center_T_m + (height_m - (model.tip.ball() ? model.tip.radius_m : 0.0)) * n;
  const scene::Pose before = slips.before;
  slips.before = pose;
  Eigen::Vector2d step_m = Eigen::Vector2d::Zero();
  if (slips.carry(n)) {
    const Vec3 arm_before_m = before.orientation * (pose.orientation.conjugate() * arm_m);
    step_m = slips.frame.transpose() * (pose.position_m + arm_m - before.position_m - arm_before_m);
  }
  const Eigen::Matrix3d C = weights.sum<Eigen::Matrix3d>(
      [&](int k) -> const Eigen::Matrix3d& { return model.shear_compliance[static_cast<std::size_t>(k)]; });
  const Eigen::Matrix2d compliance_m_per_n = slips.frame.transpose() * C * slips.frame;
  const Slip slipped = slip(*model.springs, law, contact.indentation_m, compliance_m_per_n,
                            law.force_n * (slips.frame.transpose() * sway_m_per_n), step_m, slips);
  contact.stretch_m = slips.frame * (slipped.displacement_m + compliance_m_per_n * slipped.force_n);
  contact.friction_n = -(slips.frame * slipped.force_n);
  // Of the two distributions with this moment.
  const Vec3 moment_n = slips.frame * slipped.moment_n_m2 / (law.radius_m * law.radius_m);
  contact.load.punch_shear_n = (moment_n + contact.friction_n / 5.0) / (1.0 / 3.0 - 1.0 / 5.0);
  contact.load.ball_shear_n = -contact.friction_n - contact.load.punch_shear_n;
  state.wrench.force_n += contact.friction_n;
  state.wrench.torque_nm += arm_m.cross(contact.friction_n);
}

/// Points under the tool lie on it. A point belongs to the contact where it is within the contact's radius, with a
/// little to spare, and the tool is below the free surface there.
void follow_tool(const ResponseModel& model, const ResponseContact& contact, std::int32_t near_count,
                 ResponseState& state) noexcept {
  constexpr double rim = 1.15;   // of the radius: finite strain widens the linear contact
  constexpr double slide = 0.2;  // outward, of depth times slope in the middle; chosen, as in reports/response.md
  const Vec3 p0 = contact.at.point_m, n = contact.at.normal;
  const double a_m = contact.load.radius_m;
  for (std::int32_t k = 0; k < near_count; ++k) {
    const std::int32_t i = state.near[static_cast<std::size_t>(k)];
    if (model.free[static_cast<std::size_t>(i)] == 0.0f) continue;
    const Vec3 d_m = at(model.rest_m, i) - contact.load.center_m;
    const double r_m = (d_m - d_m.dot(n) * n).norm();
    if (r_m > rim * a_m || d_m.dot(n) < -2.0 * a_m) continue;
    Vec3 u_m = at(state.field.displacement_m, i);
    const Vec3 from_axis_m = at(model.rest_m, i) + u_m - p0;
    Vec3 across_m = from_axis_m - from_axis_m.dot(n) * n;
    const double below_m = -(at(model.rest_m, i) - p0).dot(n);  // of the rest point, under the tangent plane
    const double inward_m = contact.depth_m - model.tip.height_m(across_m.norm()) - below_m;
    if (r_m > a_m && inward_m <= -u_m.dot(n)) continue;
    const double inside = std::max(1.0 - r_m * r_m / (a_m * a_m), 0.0);
    const double radius_m = across_m.norm();
    Vec3 slid_m = Vec3::Zero();
    if (radius_m > 0.0) {
      slid_m = slide * inward_m * model.tip.slope(std::min(radius_m, 0.9 * model.tip.reach_m())) * inside / radius_m *
               across_m;
    }
    const double new_inward_m = contact.depth_m - model.tip.height_m((across_m + slid_m).norm()) - below_m;
    u_m += slid_m - (u_m.dot(n) + new_inward_m) * n;
    set(state.field.displacement_m, i, u_m);
  }
}

}  // namespace

StepStatus response_force(const ResponseModel& model, const scene::Pose& given, ResponseState& state) noexcept {
  if (!given.position_m.allFinite() || !given.orientation.coeffs().allFinite() || !(given.orientation.norm() > 1e-6)) {
    return StepStatus::not_finite;
  }
  scene::Pose pose = given;
  pose.orientation.normalize();
  StepStatus status = StepStatus::ok;
  ResponseContact& contact = state.contact;
  contact = {};
  state.wrench = {};
  contact.at = scene::touch(*model.body, model.tip, pose);
  state.lap(Stage::detection);
  const Vec3 n = contact.at.normal;
  contact.depth_m = contact.at.depth_m;
  contact.load.center_m = contact.at.point_m;
  contact.load.normal = n;
  if (!(contact.depth_m > 0.0)) {
    contact.depth_m = 0.0;
    if (state.slip) *state.slip = {};
    return status;
  }
  if (contact.at.tilt > scene::tilt_max) status |= StepStatus::tilted;
  const double deepest_m = model.tip.ball() ? model.tip.radius_m : model.tables.front().largest_indentation_m();
  if (contact.depth_m > deepest_m) status |= StepStatus::tip_exceeded;

  const scene::LoadGrid& grid = model.response.grid;
  LoadPath path{grid.place(contact.at.point_m), Eigen::Vector2d::Zero()};
  const GridWeights weights(grid, path.start);
  if (!weights.inside) status |= StepStatus::outside_grid;
  const Vec3 sway = weights.sum<Vec3>([&](int k) -> Vec3 { return model.sway.col(k); });
  const Vec3 tilt = weights.sum<Vec3>([&](int k) -> Vec3 { return model.tilt.col(k); });
  const double curvature_per_m =
      weights.sum<double>([&](int k) { return model.local[static_cast<std::size_t>(k)].curvature_per_m(); });

  // Friction sways the surface down or up, as the load sways it sideways: that of the last tick.
  const double pulled_m = state.slip ? sway.dot(state.slip->force_n()) : 0.0;

  // Newton's method on the indentation; the law is convex or nearly so, and D itself is never too small a start.
  double indentation_m = contact.depth_m;
  LocalContact law;
  Vec3 shift_m_per_n = Vec3::Zero();
  for (int iteration = 0; iteration < 12; ++iteration) {
    law = local_contact(model, weights, indentation_m);
    // Radius that a ball of the same eccentricity has: of a punch 2 a^2 / (3 D).
    const double radius_m = model.tip.ball() ? 1.0 / (1.0 / model.tip.radius_m + curvature_per_m)
                                             : 2.0 * law.radius_m * law.radius_m / (3.0 * indentation_m);
    shift_m_per_n = radius_m * tilt - sway;
    path.per_n = {shift_m_per_n.dot(grid.axes.col(0)) / grid.spacing_m[0],
                  shift_m_per_n.dot(grid.axes.col(1)) / grid.spacing_m[1]};
    const double C = compliance_m_per_n(model, path.start + law.force_n * path.per_n);
    const double open_m = indentation_m + C * law.force_n + pulled_m - contact.depth_m;
    const double step_m = open_m / (1.0 + C * law.stiffness_n_per_m);
    indentation_m = std::max(indentation_m - step_m, 1e-3 * indentation_m);
    if (std::abs(step_m) < 1e-13 * contact.depth_m) break;
  }
  law = local_contact(model, weights, indentation_m);
  contact.indentation_m = indentation_m;

  // The lateral part of the same potential: how the body's share changes from place to place at this force.
  constexpr double e = 0.02;  // steps of the grid
  Eigen::Vector2d slope_j;    // per step
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    LoadPath low = path, high = path;
    low.start[axis] -= e;
    high.start[axis] += e;
    slope_j[axis] = (body_energy_j(model, high, law.force_n) - body_energy_j(model, low, law.force_n)) / (2.0 * e);
  }
  Vec3 lateral_n =
      slope_j[0] / grid.spacing_m[0] * grid.axes.col(0) + slope_j[1] / grid.spacing_m[1] * grid.axes.col(1);
  lateral_n -= lateral_n.dot(n) * n;
  // The foot of a ball moves less than its centre over a round body.
  if (model.tip.ball()) lateral_n /= 1.0 + curvature_per_m * (model.tip.radius_m - contact.depth_m);

  contact.load = {contact.at.point_m, n, law.force_n, law.radius_m, law.flat, law.widening, law.peaked};
  contact.energy_j = local_energy_j(model, weights, indentation_m) + contact.depth_m * law.force_n -
                     indentation_m * law.force_n - body_energy_j(model, path, law.force_n);
  state.wrench.force_n = law.force_n * n + lateral_n;
  const Vec3 center_m = pose.orientation * model.tip.center_T_m;
  const Vec3 arm_m = model.tip.ball() ? center_m : Vec3(center_m + law.force_n * shift_m_per_n);
  state.wrench.torque_nm = arm_m.cross(state.wrench.force_n);
  state.lap(Stage::force);
  if (state.slip) {
    add_friction(model, pose, weights, law, sway, state);
    state.lap(Stage::friction);
  }
  const Eigen::Vector2d moved = law.force_n * path.per_n;
  const scene::SurfaceQuery loaded =
      model.body->query(contact.at.point_m - contact.stretch_m + moved[0] * grid.spacing_m[0] * grid.axes.col(0) +
                        moved[1] * grid.spacing_m[1] * grid.axes.col(1));
  contact.load.center_m = loaded.point_m;
  contact.load.normal = loaded.normal;
  return status;
}

void response_shape(const ResponseModel& model, ResponseState& state) noexcept {
  const FlushTinyNumbers flush;
  const ResponseContact& contact = state.contact;
  if (!(contact.load.force_n > 0.0)) {
    if (state.deformed) state.field.reset(model.rest_normal);
    state.deformed = false;
    return;
  }
  state.deformed = true;
  const std::int32_t near_count = spread_displacements_m(contact.load, model.half_space, model.rest_m,
                                                         state.field.displacement_m, state.near.data());
  for (std::int32_t k = 0; k < near_count; ++k) {
    const std::int32_t i = state.near[static_cast<std::size_t>(k)];
    set(state.field.displacement_m, i, spread_displacement_m(contact.load, model.half_space, at(model.rest_m, i)));
  }
  const scene::LoadGrid& grid = model.response.grid;
  // The body carries the load where the tool is.
  const GridWeights weights(grid, grid.place(contact.load.center_m + contact.stretch_m));
  const Vec3 lateral_n = state.wrench.force_n - state.wrench.force_n.dot(contact.at.normal) * contact.at.normal;
  for (int k = 0; k < weights.count; ++k) {
    const auto [point, weight] = weights.terms[static_cast<std::size_t>(k)];
    add_column(model.response.smooth_m_per_n.col(point).data(), static_cast<float>(weight * contact.load.force_n),
               state.field.displacement_m);
    if (!state.slip) continue;
    const Eigen::Vector2d along_n = weight * grid.along(point).transpose() * -lateral_n;
    for (int axis = 0; axis < 2; ++axis) {
      add_column(model.response.smooth_m_per_n.col(grid.count() + 2 * point + axis).data(),
                 static_cast<float>(along_n[axis]), state.field.displacement_m);
    }
  }
  hold(model.free, state.field.displacement_m);
  state.lap(Stage::interpolation);
  follow_tool(model, contact, near_count, state);
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
