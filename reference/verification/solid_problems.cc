// Solids under prescribed displacements and dead loads.
#include "reference/mesh/inclusions.h"
#include "reference/verification/closed_forms.h"
#include "reference/verification/problem.h"
#include "reference/verification/solids.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace touchstone::verification {
namespace {

using reference::ContactProblem;
using reference::Mesh;
using reference::State;
using scene::Kinematics;
using Vec3 = Eigen::Vector3d;

Findings patch(const Effort& effort) {
  effort.tell("uniform strain on distorted cells");
  const Eigen::Matrix3d H = (Eigen::Matrix3d() << 0.05, 0.08, -0.02, 0.01, -0.06, 0.03, 0.02, -0.04, 0.07).finished();
  Findings findings;
  for (const bool hanging : {false, true}) {
    const Mesh<3> mesh = hanging ? graded_cube(0.02) : distorted_cube(0.02);
    const PatchDeviation off = patch_deviation<3>(mesh, H, {3e6, 0.45}, Kinematics::finite);
    const std::string cells = hanging ? "hanging nodes" : "distorted cells";
    findings.checks.push_back({"displacement off, " + cells, "", 0.0, off.displacement_rel, 1e-12, 1.0, {}, {}});
    findings.checks.push_back({"pressure varies, " + cells, "", 0.0, off.pressure_rel, 1e-7, 1.0, {}, {}});
  }
  findings.notes.emplace_back("Relative to the body's size and to Young's modulus: round-off.");
  return findings;
}

Findings uniaxial(const Effort& effort) {
  Findings findings;
  for (const double nu : {0.3, 0.5}) {
    for (const double stretch : {0.7, 0.85, 1.5}) {
      effort.tell(fmt::format("stretch {:.3g}, nu = {:.3g}", stretch, nu));
      const scene::Material rubber{3e6, nu};
      findings.checks.push_back({fmt::format("stress at stretch {:.3g}, nu = {:.3g}", stretch, nu),
                                 "Pa",
                                 neo_hookean_bar_pa(rubber, stretch),
                                 pull_bar(rubber, stretch).nominal_stress_pa,
                                 limit_of_closed_form,
                                 0.0,
                                 {},
                                 {}});
    }
  }
  return findings;
}

/// A block under uniform stress by a dead force on its top, fixed in y: displacement of the top over the height.
double plane_strain_top(double mu_pa, double pressure_pa) {
  const Mesh<3> mesh = lattice_mesh<3>({2, 1, 2}, [](const Vec3& x) { return x; });
  ContactProblem<3> body(mesh, {3.0 * mu_pa, 0.5}, Kinematics::finite, false, false);
  for (const int node : nodes_where<3>(mesh, [](const Vec3&) { return true; })) body.prescribe(node, 1, 0.0);
  for (const int i : {0, 2}) {
    for (const int node : nodes_where<3>(mesh, [i](const Vec3& x_m) { return x_m[i] == 0.0; })) {
      body.prescribe(node, i, 0.0);
    }
  }
  const State<3> state = solve_in_steps<3>(body, 2, "plane-strain block", [&](double share) {
    body.load(traction_force_n(mesh, {0.0, 0.0, share * pressure_pa}, [](const Vec3& x_m) { return x_m.z() == 1.0; }));
  });
  return state.u_m(2, node_at<3>(mesh, Vec3::Ones()));
}

Findings plane_strain(const Effort& effort) {
  effort.tell("dead force on a block");
  constexpr double mu_pa = 2.0 * 1.2345, force_n = -0.876;
  return {{{"displacement of the top",
            "m",
            plane_strain_stretch(mu_pa, force_n) - 1.0,
            plane_strain_top(mu_pa, force_n),
            limit_of_closed_form,
            0.0,
            {},
            {}}},
          {}};
}

Findings thick_sphere(const Effort& effort) {
  Findings findings;
  for (const double stretch : {1.25, 1.5, 2.0}) {
    std::vector<double> pressures, errors;
    double exact = 0.0;
    for (const int n : {4, 8, 16}) {
      effort.tell(fmt::format("inner stretch {:.3g}, {} cells through the wall", stretch, n));
      const InflatedSphere sphere = inflate_sphere(stretch, n);
      pressures.push_back(sphere.inner_pressure_pa / sphere.shear_modulus_pa);
      errors.push_back(sphere.displacement_error_l2);
      exact = sphere.exact_pressure_pa / sphere.shear_modulus_pa;
    }
    findings.checks.push_back(from_levels(fmt::format("pressure / mu at stretch {:.3g}", stretch), "", exact,
                                          limit_of_closed_form, pressures));
    if (stretch > 1.25) continue;
    Check order{"order of the displacement's error",
                "",
                3.0,
                observed_order(errors[1], errors[2]).value_or(0.0),
                0.3,
                1.0,
                {},
                {}};
    findings.checks.push_back(order);
  }
  findings.notes.emplace_back("Order 3 in the L2 norm is that of quadratic displacement with linear pressure.");
  return findings;
}

/// Displacement of the top's centre over the height at 20, 40, ... % of the full pressure.
std::vector<double> reese_block(int cells, int last, const Effort& effort) {
  constexpr double side_m = 1e-3, nu = 0.4999, mu_pa = 80.194e6, full_pa = 400e6;
  const Mesh<3> mesh = lattice_mesh<3>({cells, cells, cells}, [=](const Vec3& x) -> Vec3 { return side_m * x; });
  ContactProblem<3> body(mesh, {2.0 * mu_pa * (1.0 + nu), nu}, Kinematics::finite, true, true);
  for (const int i : {0, 1, 2}) {
    for (const int node : nodes_where<3>(mesh, [i](const Vec3& x_m) { return x_m[i] == 0.0; })) {
      body.prescribe(node, i, 0.0);
    }
  }
  for (const int node : nodes_where<3>(mesh, [](const Vec3& x_m) { return x_m.z() == side_m; })) {
    for (const int i : {0, 1}) body.prescribe(node, i, 0.0);
  }
  const int corner = node_at<3>(mesh, {0.0, 0.0, side_m});
  const Nodal<3> full_n = traction_force_n(mesh, {0.0, 0.0, -full_pa}, [](const Vec3& x_m) {
    return x_m.z() == side_m && x_m.x() < 0.5 * side_m && x_m.y() < 0.5 * side_m;
  });
  std::vector<double> sunk;
  State<3> state = body.rest();
  constexpr int steps_each = 4;
  for (int step = 1; step <= last * steps_each; ++step) {
    effort.tell(std::to_string(cells) + " cells a side, load step " + std::to_string(step));
    body.load(0.2 * step / steps_each * full_n);
    advance(body, state, "Reese block, step " + std::to_string(step));
    if (step % steps_each == 0) sunk.push_back(state.u_m(2, corner) / side_m);
  }
  return sunk;
}

Findings reese(const Effort& effort) {
  constexpr std::array printed_4{-.2186, -.4233, -.5852, -.6978, -.7719};
  constexpr std::array printed_8{-.2197, -.4249};
  Findings findings;
  const auto add = [&](int cells, const auto& printed) {
    const std::vector<double> sunk = reese_block(cells, static_cast<int>(printed.size()), effort);
    for (std::size_t k = 0; k < printed.size(); ++k) {
      findings.checks.push_back(
          {"top at p/p0 = " + std::to_string(20 * (k + 1)) + ", " + std::to_string(cells) + " cells a side",
           "",
           printed[k],
           sunk[k],
           limit_of_table,
           0.0,
           {},
           {}});
    }
  };
  add(4, printed_4);
  if (!effort.quick) add(8, printed_8);
  findings.notes.emplace_back("The printed table is of the same element on the same cells, and has four digits.");
  return findings;
}

/// Upward displacement of the middle of the free edge of Cook's membrane, in plane strain, n x n cells [m].
double cook_tip_m(int n) {
  constexpr double mm = 1e-3, nu = 0.3, mu_pa = 422.5e3, force_n = 1.0;
  const Mesh<3> mesh = lattice_mesh<3>({n, 1, n}, [=](const Vec3& x) -> Vec3 {
    const double low = 44.0 * x[0], high = 44.0 + 16.0 * x[0];
    return mm * Vec3(48.0 * x[0], x[1], low + (high - low) * x[2]);
  });
  ContactProblem<3> body(mesh, {2.0 * mu_pa * (1.0 + nu), nu}, Kinematics::finite, false, false);
  for (const int node : nodes_where<3>(mesh, [](const Vec3&) { return true; })) body.prescribe(node, 1, 0.0);
  for (const int node : nodes_where<3>(mesh, [](const Vec3& x_m) { return x_m.x() == 0.0; })) {
    for (const int i : {0, 2}) body.prescribe(node, i, 0.0);
  }
  constexpr double end_m = 48.0 * mm, edge_m2 = 16.0 * mm * 1.0 * mm;
  const Nodal<3> full_n = traction_force_n(mesh, {0.0, 0.0, force_n / edge_m2},
                                           [](const Vec3& x_m) { return x_m.x() > end_m * (1.0 - 1e-9); });
  const State<3> state =
      solve_in_steps<3>(body, 4, "Cook's membrane", [&](double share) { body.load(share * full_n); });
  return state.u_m(2, node_at<3>(mesh, mm * Vec3(48.0, 0.0, 52.0)));
}

Findings cook(const Effort& effort) {
  std::vector<double> tips_m;
  for (int n = 4; n <= (effort.quick ? 16 : 32); n *= 2) {
    effort.tell(std::to_string(n) + " x " + std::to_string(n) + " cells");
    tips_m.push_back(cook_tip_m(n));
  }
  return {{from_levels("the tip's rise", "m", 14.74e-3, limit_of_table, tips_m)},
          {"The printed value is of kappa/4 (J^2 - 1 - 2 ln J) for the volume, ours kappa/2 (J - 1)^2: equal at rest, "
           "and to second order in the volume change."}};
}

/// Tip deflection over that of the beam formula, in small strain: a square cantilever with another material in its
/// middle third.
double cantilever_over_beam(double length_m, double height_m, double ratio, int cells_along, int cells_high) {
  constexpr double E_pa = 3e6, nu = 0.3, force_n = 1e-6;
  // The half y >= 0 of the beam, its axis along x.
  Mesh<3> mesh = lattice_mesh<3>({cells_along, std::max(1, cells_high / 2), cells_high}, [&](const Vec3& x) -> Vec3 {
    return {length_m * x[0], 0.5 * height_m * x[1], height_m * (x[2] - 0.5)};
  });
  scene::Body with_middle;
  scene::Inclusion& middle = with_middle.inclusions.emplace_back();
  middle.shape = scene::BodyShape::box;
  middle.size_m = {length_m / 3.0, 2.0 * height_m, 2.0 * height_m};
  middle.center_m = {0.5 * length_m, 0.0, 0.0};
  middle.material = {ratio * E_pa, nu};
  reference::embed_inclusions(with_middle, mesh);
  ContactProblem<3> body(mesh, {E_pa, nu}, Kinematics::small, false, true);
  for (const int node : nodes_where<3>(mesh, [](const Vec3& x_m) { return x_m.x() == 0.0; })) {
    for (const int i : {0, 1, 2}) body.prescribe(node, i, 0.0);
  }
  for (const int node : nodes_where<3>(mesh, [](const Vec3& x_m) { return x_m.y() == 0.0; })) {
    body.prescribe(node, 1, 0.0);
  }
  const Vec3 traction_pa(0.0, 0.0, force_n / (height_m * height_m));
  const State<3> state = solve_in_steps<3>(body, 1, "cantilever", [&](double) {
    body.load(traction_force_n(mesh, traction_pa, [&](const Vec3& x_m) { return x_m.x() > (1.0 - 1e-9) * length_m; }));
  });
  const double I_m4 = std::pow(height_m, 4) / 12.0;
  return state.u_m(2, node_at<3>(mesh, {length_m, 0.0, 0.0})) /
         cantilever_tip_m(force_n, length_m, E_pa * I_m4, ratio * E_pa * I_m4, length_m / 3.0, 2.0 * length_m / 3.0);
}

Findings cantilever(const Effort& effort) {
  constexpr double height_m = 0.002, slender = 120.0;
  Findings findings;
  for (const double ratio : {1.0, 1.0 / 89.0, 89.0}) {
    if (effort.quick && ratio != 89.0) continue;
    const std::string at = fmt::format("E ratio {:.3g}", ratio);
    const auto tip = [&](double slenderness, int cells_high) {
      effort.tell(fmt::format("{}, {:.3g} heights long, {} cells high", at, slenderness, cells_high));
      const int cells_along = static_cast<int>(0.3 * slenderness) * cells_high;
      return cantilever_over_beam(slenderness * height_m, height_m, ratio, cells_along, cells_high);
    };
    std::vector<double> tips;
    for (const int cells_high : {1, 2, 4}) tips.push_back(tip(slender, cells_high));
    findings.checks.push_back(from_levels("tip over the beam formula, " + at, "", 1.0, limit_of_closed_form, tips));
    const double shorter = tip(0.5 * slender, 4);
    findings.notes.push_back(fmt::format(
        "{}: off by {:.3g} % with a length of {:.3g} heights and by {:.3g} % with {:.3g} on cells of equal size: "
        "ends and joints, where a solid differs from a beam. Without them, {:.3g} %.",
        at, 100.0 * (tips.back() - 1.0), slender, 100.0 * (shorter - 1.0), 0.5 * slender,
        100.0 * (2.0 * tips.back() - shorter - 1.0)));
  }
  return findings;
}

}  // namespace

std::vector<Problem> solid_problems() {
  return {
      {"patch", "Uniform strain on distorted cells and across hanging nodes", "patch test", patch},
      {"uniaxial", "Bar between lubricated plates, finite strain", "closed form of the material law", uniaxial},
      {"plane-strain-block", "Incompressible block in plane strain under a dead force", "Code_Aster SSNV187",
       plane_strain},
      {"thick-sphere", "Thick incompressible sphere, inflated", "Green and Zerna, Theoretical Elasticity, 3.10",
       thick_sphere},
      {"reese-block", "Nearly incompressible block under a dead pressure on its middle", "deal.II step-44, its table",
       reese},
      {"cook", "Cook's membrane, compressible, plane strain, finite strain",
       "deal.II code gallery, quasi-static finite-strain elasticity", cook},
      {"cantilever", "Cantilever with another material in its middle third, in space, small strain",
       "beam formula by unit load", cantilever},
  };
}

}  // namespace touchstone::verification
