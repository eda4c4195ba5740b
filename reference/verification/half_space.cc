#include "reference/verification/half_space.h"

#include "reference/contact/contact_problem.h"
#include "reference/contact/interior.h"
#include "reference/contact/load_path.h"
#include "reference/mesh/sampling.h"
#include "reference/run/model_choice.h"
#include "reference/solver.h"
#include "reference/tool/tool_distance.h"
#include "reference/verification/solids.h"
#include "scene/shape/revolution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace touchstone::verification {
namespace {

using scene::Vec3;

/// Distance of a convex surface of revolution about z. Without a Hessian, which small kinematics do not need.
class TurnedTool final : public reference::ToolDistance {
 public:
  explicit TurnedTool(const scene::Profile& profile) : shape_(profile) {}
  [[nodiscard]] reference::Gap<3> at(const Vec3& p_T_m) const override {
    const scene::SurfaceQuery foot = shape_.query(p_T_m);
    const Vec3 from_m = p_T_m - foot.point_m;
    const double length_m = from_m.norm();
    // Outside an edge or a tip the gradient points from the closest point, not along a normal there.
    const bool off = foot.signed_distance_m > 1e-9 * half_width_m();
    return {foot.signed_distance_m, off ? Vec3(from_m / length_m) : foot.normal, scene::Mat3::Zero()};
  }
  [[nodiscard]] scene::Bounds bounds() const override { return shape_.bounds(); }
  [[nodiscard]] double half_width_m() const override {
    const scene::Bounds box = shape_.bounds();
    return 0.5 * (box.upper_m - box.lower_m).minCoeff();
  }

 private:
  scene::Revolution shape_;
};

scene::Tool cylinder(double radius_m, double edge_radius_m) {
  scene::Tool tool;
  tool.shape = scene::ToolShape::cylinder;
  tool.radius_m = radius_m;
  tool.length_m = 4.0 * radius_m;
  tool.edge_radius_m = edge_radius_m;
  return tool;
}

double stick_radius_m(const reference::ContactProblem<2>& body, const reference::State<2>& state) {
  double sticks_m = 0.0, slips_m = std::numeric_limits<double>::infinity();
  const std::vector<reference::NodeContact<2>> contacts = body.node_contacts(state);
  const auto radius_m = [&](const reference::NodeContact<2>& contact) { return body.mesh().points_m(0, contact.node); };
  for (const auto& contact : contacts) {
    if (!contact.slips) sticks_m = std::max(sticks_m, radius_m(contact));
  }
  for (const auto& contact : contacts) {
    if (contact.slips && radius_m(contact) > sticks_m) slips_m = std::min(slips_m, radius_m(contact));
  }
  return std::isfinite(slips_m) ? 0.5 * (sticks_m + slips_m) : sticks_m;
}

}  // namespace

Punch ball_punch(double radius_m, double depth_m) {
  scene::Tool tool;
  tool.radius_m = radius_m;
  return {reference::tool_distance(tool), radius_m, std::min(std::sqrt(radius_m * depth_m), radius_m)};
}

Punch flat_punch(double radius_m) {
  return {reference::tool_distance(cylinder(radius_m, 0.0)), 2.0 * radius_m, radius_m, {{radius_m, 0.0}}};
}

Punch rounded_punch(double radius_m, double edge_radius_m, double depth_m) {
  const double flat_m = radius_m - edge_radius_m, up_m = std::min(0.5 * depth_m, edge_radius_m);
  const double patch_m = flat_m + std::sqrt(up_m * (2.0 * edge_radius_m - up_m));
  return {reference::tool_distance(cylinder(radius_m, edge_radius_m)),
          2.0 * radius_m,
          patch_m,
          {{flat_m, edge_radius_m}, {patch_m, edge_radius_m}}};
}

Punch cone_punch(double half_angle, double tip_radius_m, double depth_m) {
  const double patch_m = 0.5 * depth_m * std::tan(half_angle);
  // Three times as wide as needed; the tip, or the ball in it, is at z = 0.
  const double wide_m = 6.0 * patch_m, slope = 1.0 / std::tan(half_angle);
  scene::Profile profile;
  const double top_m = 2.0 * wide_m * slope;
  if (tip_radius_m > 0.0) {
    const double touch_r_m = tip_radius_m * std::cos(half_angle);
    const double touch_z_m = tip_radius_m * (1.0 - std::sin(half_angle));
    profile.rz_m = {{0.0, 0.0}, {touch_r_m, touch_z_m}, {wide_m, touch_z_m + slope * (wide_m - touch_r_m)}};
    profile.arc_radius_m = {tip_radius_m, 0.0, 0.0, 0.0};
  } else {
    profile.rz_m = {{0.0, 0.0}, {wide_m, slope * wide_m}};
  }
  profile.rz_m.emplace_back(wide_m, top_m);
  profile.rz_m.emplace_back(0.0, top_m);
  return {std::make_shared<TurnedTool>(profile), 0.0, patch_m, {{0.0, tip_radius_m}}};
}

HalfSpaceAnswer indent_half_space(const HalfSpaceProblem& problem) {
  const Punch& punch = problem.punch;
  const double L_m = problem.domain_over_patch * punch.patch_radius_m;
  scene::Scene scene;
  scene.body.shape = scene::BodyShape::revolution;
  scene.body.profile = {{{0.0, 0.0}, {L_m, 0.0}, {L_m, L_m}, {0.0, L_m}}, {}};
  scene.body.material = problem.material;
  const Vec3 top_m(0.0, 0.0, L_m);
  reference::ContactPatch patch{
      top_m, Vec3::UnitZ(), problem.depth_m, punch.patch_radius_m, {{top_m, punch.patch_radius_m}}, {}};
  for (const Punch::Rim& rim : punch.rims) patch.rims.push_back({{rim.radius_m, 0.0, L_m}, rim.bend_radius_m});
  reference::ModelChoice choice;
  choice.dim = 2;
  choice.tool = punch.tool;
  choice.contacts = {patch};
  choice.half_width_m = punch.patch_radius_m;
  const reference::Discretisation<2> mesh = reference::level_mesh<2>(scene, choice, problem.level);
  reference::ContactProblem<2> body(mesh, problem.material, problem.kinematics, false, false);

  if (problem.friction) body.set_friction({*problem.friction, 1.0, *problem.friction}, 0.0);
  const auto tool_at = [&](double share) {
    const Vec3 center_m(0.0, 0.0, L_m + punch.tip_m - share * problem.depth_m);
    return reference::RigidTool<2>(punch.tool, {center_m, Eigen::Quaterniond::Identity()});
  };
  reference::LoadPath<2> path(body, tool_at, tool_at);
  reference::Solved<2> end{0.0, body.rest(), false};
  std::optional<reference::Solved<2>> before;
  int newton_iterations = 0;
  for (int step = 1; step <= problem.steps; ++step) {
    reference::Solved<2> next;
    const double share = std::pow(static_cast<double>(step) / problem.steps, 2);
    const reference::AdvanceReport report = path.advance(before ? &*before : nullptr, end, share, next, {}, {});
    if (!report.converged) throw reference::NotConverged("tool on half space: " + report.last.trouble);
    newton_iterations += report.newton_iterations;
    before = std::exchange(end, std::move(next));
  }
  const reference::Observation seen = body.observe(end.state);
  HalfSpaceAnswer answer;
  answer.force_n = seen.force_n.z();
  answer.contact_radius_m = seen.half_axes_m()[0];
  answer.stick_radius_m = problem.friction ? stick_radius_m(body, end.state) : 0.0;
  answer.peak_pressure_pa = axis_pressure_pa(body, end.state, problem.kinematics);
  answer.equilibrium_rel = seen.equilibrium_rel;
  answer.node_penetration_m = seen.node_penetration_m;
  answer.unknowns = body.unknowns();
  answer.newton_iterations = newton_iterations;
  if (problem.radii_m.size() > 0) {
    Eigen::Matrix3Xd points_m = Eigen::Matrix3Xd::Zero(3, problem.radii_m.size());
    points_m.row(0) = problem.radii_m.transpose();
    points_m.row(2).setConstant(L_m);
    const reference::SurfaceSampler<2> sampler(mesh, points_m, false, false);
    answer.settlement_m = -sampler.at_points(end.state.u_m).row(2).transpose();
    const Eigen::Matrix3Xd traction_pa = sampler.at_points(body.contact_traction(end.state).nodal_pa);
    answer.pressure_pa = -traction_pa.row(2).transpose();
    answer.shear_pa = traction_pa.row(0).transpose();
  }
  if (problem.below_m.size() > 0) {
    Eigen::Matrix3Xd points_m = Eigen::Matrix3Xd::Zero(3, problem.below_m.size());
    points_m.row(2) = L_m - problem.below_m.transpose().array();
    const Eigen::Matrix<double, 9, Eigen::Dynamic> stress_pa =
        reference::BodySampler<2>(mesh, points_m, false, false)
            .tensors(reference::interior(mesh, problem.material, problem.kinematics, end.state).stress_pa);
    answer.stress_zz_pa = stress_pa.row(8);
    answer.stress_rr_pa = stress_pa.row(0);
  }
  return answer;
}

}  // namespace touchstone::verification
