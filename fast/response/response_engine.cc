#include "fast/response/response_engine.h"

#include "fast/response/response_step.h"
#include "scene/base/error.h"
#include "scene/response/response_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Of the tables at the grid's points.
template <class Value>
double of_tables(const TipLaw& tip, const ResponseContact& contact, const Value& value) {
  if (tip.tables.size() == 1) return value(tip.tables.front());
  return contact.weights.sum<double>([&](int k) { return value(tip.tables[static_cast<std::size_t>(k)]); });
}

/// Pressure of a contact at a point under the tool, along the load.
/// @param off_m  from the load's centre
double pressure_pa(const TipLaw& tip, const ResponseContact& contact, const Vec3& off_m) {
  if (tip.tip.ball() && !tip.tip.line()) return spread_pressure_pa(contact.load, contact.load.center_m + off_m);
  Vec3 across_m = off_m - off_m.dot(contact.load.normal) * contact.load.normal;
  double along_m = 0.0;
  if (tip.tip.line()) {
    const Vec3 line = contact.half_line_m.normalized();
    along_m = across_m.dot(line);
    across_m -= along_m * line;
  }
  return contact.load.force_n * of_tables(tip, contact, [&](const ContactTable& table) {
           return table.pressure_per_m2(contact.indentation_m, across_m.norm(), along_m);
         });
}

/// Traction on the body at a point under the tool. Pressure along the tool's normal is force along the load per area
/// across it, and so is the normal traction on a surface of any slope. Shear is along the tool's surface.
Vec3 traction_pa(const TipLaw& law, const ResponseContact& contact, const Vec3& x_m, const Vec3& axis) {
  const scene::ToolTip& tip = law.tip;
  const double pressure = pressure_pa(law, contact, x_m - contact.moved_m() - contact.load.center_m);
  if (pressure == 0.0) return Vec3::Zero();
  Vec3 from_axis_m = x_m - contact.at.point_m;
  if (tip.line()) {
    const Vec3 line = contact.half_line_m.normalized();
    const double reach_m = tip.half_line_T_m.norm();
    from_axis_m -= std::clamp(from_axis_m.dot(line), -reach_m, reach_m) * line;
  }
  const Vec3 across_m = from_axis_m - from_axis_m.dot(axis) * axis;
  const double r_m = across_m.norm();
  const double slope = tip.slope(std::min(r_m, 0.99 * tip.reach_m()));
  const Vec3 out = (r_m > 0.0 ? Vec3(axis + slope / r_m * across_m) : axis).normalized();
  if (contact.friction_n.isZero(0.0)) return pressure * out;
  const Vec3 shear_pa = spread_shear_pa(contact.load, x_m - contact.moved_m());
  return pressure * out + shear_pa - shear_pa.dot(out) * out;
}

}  // namespace

scene::Response stored_response(const scene::Scene& scene, const scene::Surface& surface) {
  const std::string identity =
      scene::response_identity(scene.body, scene::load_grid(scene).grid.value(), surface, scene::load_kinds(scene));
  const std::filesystem::path file = scene::response_path(scene.fast.store, identity);
  if (!std::filesystem::exists(file)) {
    throw scene::InputError("fast.formulation: the response of this body is not there; expected the file " +
                            file.string() + ", which `touchstone prepare` writes for this scene");
  }
  return scene::read_response(file, identity);
}

ResponseEngine::ResponseEngine(const scene::Scene& scene, scene::Surface surface, scene::Response response)
    : model_(scene, std::move(surface), std::move(response)),
      state_(model_),
      tool_reach_m_(scene::tool_surface(scene.tool, scene.fast.tool_samples).points_m.colwise().norm().maxCoeff()) {}

void ResponseEngine::restart() {
  state_ = ResponseState(model_);
  restart_hash();
}

StepStatus ResponseEngine::force(const scene::Pose& pose) noexcept {
  state_.clock = clock();
  return response_force(model_, pose, state_);
}

StepStatus ResponseEngine::shape() noexcept {
  state_.clock = clock();
  response_shape(model_, state_);
  return StepStatus::ok;
}

scene::InstantRecord ResponseEngine::record(double time_s, const scene::Pose& tool, double depth_m) const {
  scene::InstantRecord record;
  record.time_s = time_s;
  record.tool = tool;
  record.depth_m = depth_m;
  record.displacement_m = matrix_of(state_.field.displacement_m);
  record.traction_pa.setZero(3, record.displacement_m.cols());
  record.support_force_n = state_.wrench.force_n;
  for (std::size_t k = 0; k < model_.tips.size(); ++k) {
    const ResponseContact& contact = state_.contacts[k];
    if (!contact.touches()) continue;
    const TipLaw& law = model_.tips[k];
    const scene::ToolTip& tip = law.tip;
    const Vec3 axis = tip.ball() ? -contact.at.normal : Vec3(tool.orientation * tip.axis_T);
    for (Eigen::Index i = 0; i < record.traction_pa.cols(); ++i) {
      if (model_.surface.normals.col(i).dot(contact.load.normal) <= 0.0) continue;
      const Vec3 x_m = model_.surface.points_m.col(i) + record.displacement_m.col(i);
      record.traction_pa.col(i) += traction_pa(law, contact, x_m, axis);
    }
    const double peak_pa = tip.ball() && !tip.line()
                               ? pressure_pa(law, contact, Vec3::Zero())
                               : contact.load.force_n * of_tables(law, contact, [&](const ContactTable& table) {
                                   return table.largest_pressure_per_m2(contact.indentation_m);
                                 });
    record.pressure_peak_pa = std::max(record.pressure_peak_pa, peak_pa);
    const double radius_m = contact.load.widening * contact.law.radius_m;
    record.regions.push_back({.depth_m = contact.depth_m,
                              .force_n = contact.wrench.force_n,
                              .torque_nm = contact.wrench.torque_nm,
                              .area_m2 = radius_m * (std::numbers::pi * radius_m + 4.0 * contact.law.half_line_m),
                              .id = static_cast<int>(k),
                              .friction_n = contact.friction_n,
                              .sliding = state_.slip && state_.slip->sliding});
  }
  return record;
}

}  // namespace touchstone::fast
