#include "reference/verification/shifted_ball.h"

#include "reference/contact/contact_problem.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/sampling.h"
#include "reference/tool/tool_distance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace touchstone::reference {

std::vector<ShiftedBallStep> shift_ball(const ShiftedBall& problem) {
  const double a_m = std::sqrt(problem.radius_m * problem.depth_m), extent_m = problem.extent * a_m;
  BlockSpec spec;
  spec.lower_m = {-extent_m, 0.0, -extent_m};
  spec.upper_m = {extent_m, extent_m, 0.0};
  spec.symmetric_y = true;
  spec.grading.growth = 0.9;
  spec.grading.largest_m = extent_m;
  spec.grading.discs.push_back({{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, a_m, a_m / problem.cells_per_radius});
  ContactProblem<3> body(block_mesh(spec), problem.material, scene::Kinematics::small, false, true);
  const auto place_tool = [&](double shift_m) {
    return ball_tool<3>(problem.radius_m, {shift_m, 0.0, problem.radius_m - problem.depth_m});
  };
  State<3> state = body.rest();
  const auto solve = [&](double shift_m) {
    body.set_tool(place_tool(shift_m));
    const NewtonReport report = body.solve(state);
    if (!report.converged) throw std::runtime_error("the shifted ball did not converge: " + report.trouble);
    return report.iterations;
  };
  solve(0.0);
  body.set_friction({problem.friction, 1.0, problem.friction}, 0.0);
  body.note_places(place_tool(0.0), state);
  std::vector<ShiftedBallStep> steps;
  for (int step = 1; step <= problem.steps; ++step) {
    ShiftedBallStep& now = steps.emplace_back();
    now.shift_m = problem.shift_m * step / problem.steps;
    now.newton_iterations = solve(now.shift_m);
    const Observation seen = body.observe(state);
    now.normal_n = seen.force_n.z();
    now.tangential_n = -seen.force_n.x();
    now.stuck_share = seen.regions.at(0).stuck_share;
    if (problem.places_m.size() > 0) {
      Eigen::Matrix3Xd places_m = Eigen::Matrix3Xd::Zero(3, problem.places_m.size());
      places_m.row(0) = problem.places_m.transpose();
      now.shear_pa = SurfaceSampler<3>(body.mesh(), places_m, false, true)
                         .at_points(body.contact_traction(state).nodal_pa)
                         .row(0)
                         .transpose();
    }
    now.dissipated_j = seen.dissipated_j;
  }
  return steps;
}

double mindlin_force(const ShiftedBall& problem, double shift_m) {
  const double nu = problem.material.poissons_ratio;
  const double slides_m = problem.friction * problem.depth_m * (2.0 - nu) / (2.0 * (1.0 - nu));
  return 1.0 - std::pow(std::max(0.0, 1.0 - shift_m / slides_m), 1.5);
}

double mindlin_stick_radius(double force) { return std::cbrt(1.0 - force); }

double mindlin_shear(double stick_radius, double r_over_a) {
  const auto ellipse = [](double x) { return std::sqrt(std::max(0.0, 1.0 - x * x)); };
  return ellipse(r_over_a) - stick_radius * ellipse(r_over_a / stick_radius);
}

double stick_radius_of_share(double stuck_share) { return std::sqrt(1.0 - std::pow(1.0 - stuck_share, 2.0 / 3.0)); }

}  // namespace touchstone::reference
