#include "reference/half_space.h"

#include "reference/contact_problem.h"
#include "reference/load_path.h"
#include "reference/mesh.h"
#include "reference/solver.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {

HalfSpaceAnswer indent_half_space(const HalfSpaceProblem& problem) {
  const double R_m = problem.tool_radius_m;
  const double a_m = std::min(std::sqrt(R_m * problem.depth_m), R_m);
  const double L_m = problem.domain_over_contact_radius * a_m;
  CylinderSpec spec{L_m, L_m, {}};
  spec.grading.growth = 0.25;
  spec.grading.largest_m = 0.25 * L_m;
  spec.grading.discs.push_back({{0.0, L_m}, {0.0, 1.0}, 1.05 * a_m, a_m / problem.cells_per_contact_radius});
  ContactProblem<2> body(cylinder_mesh(spec), problem.material, problem.kinematics, false, false);

  const Solved<2> rest{0.0, body.rest(), false};
  Solved<2> end;
  LoadPath<2> path(body, [&](double share) -> std::optional<RigidTool<2>> {
    return ball_tool<2>(R_m, {0.0, L_m + R_m - share * problem.depth_m});
  });
  const AdvanceReport report = path.advance(nullptr, rest, 1.0, end, {}, {});
  if (!report.converged) throw NotConverged("ball on half space: " + report.last.trouble);
  const Observation seen = body.observe(end.state);
  return {seen.force_n.z(),        seen.contact_radius_m, seen.equilibrium_rel,
          seen.node_penetration_m, body.unknowns(),       report.newton_iterations};
}

}  // namespace touchstone::reference
