// Friction against closed forms, its own laws, and energy.
#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/mesh/mesh.h"
#include "reference/tool/tool_distance.h"
#include "reference/verification/closed_forms.h"
#include "reference/verification/shifted_ball.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace touchstone::reference {
namespace {

using scene::Vec3;

/// A half space that occupies z > 0 of its own frame.
class FlatTool : public ToolDistance {
 public:
  [[nodiscard]] Gap<3> at(const Vec3& p_T_m) const override {
    return {-p_T_m.z(), -Vec3::UnitZ(), scene::Mat3::Zero()};
  }
  [[nodiscard]] scene::Bounds bounds() const override { return {{-1, -1, 0}, {1, 1, 1}}; }
  [[nodiscard]] double half_width_m() const override { return 0.01; }
};

/// A ball of 4 mm at the end of a tool ten times as wide, like the tail of a mallet.
class Tail : public ToolDistance {
 public:
  static constexpr double radius_m = 0.004;
  [[nodiscard]] Gap<3> at(const Vec3& p_T_m) const override {
    const double r_m = p_T_m.norm();
    const Vec3 out = p_T_m / r_m;
    return {r_m - radius_m, out, (scene::Mat3::Identity() - out * out.transpose()) / r_m};
  }
  [[nodiscard]] scene::Bounds bounds() const override { return {{-0.04, -0.04, -radius_m}, {0.04, 0.04, 0.08}}; }
  [[nodiscard]] double half_width_m() const override { return 0.04; }
};

/// One half of a block of 40 x 40 x 20 mm, its top at z = 0.
ContactProblem<3> block(double cell_m, double poissons_ratio, double disc_m = 0.012) {
  BlockSpec spec{{-0.02, 0.0, -0.02}, {0.02, 0.02, 0.0}, false, true, {{}, 0.9, 0.01}};
  spec.grading.discs.push_back({{0, 0, 0}, {0, 0, 1}, disc_m, cell_m});
  return {block_mesh(spec), {3e6, poissons_ratio}, scene::Kinematics::finite, false, true, 1};
}

/// Sums over a region of the whole body: normal force, friction, limits; and the largest excess over a node's limit.
struct Sums {
  double normal_n = 0.0, friction_n = 0.0, limit_n = 0.0, excess_n = 0.0;
  bool all_slip = true, all_stick = true;
};
Sums sums(const ContactProblem<3>& body, const State<3>& state) {
  Sums sum;
  for (const NodeContact<3>& contact : body.node_contacts(state)) {
    EXPECT_GE(contact.normal_n, 0.0);
    const double limit_n = contact.coefficient * contact.normal_n;
    sum.normal_n += 2.0 * contact.normal_n;
    sum.friction_n += 2.0 * contact.friction_n.norm();
    sum.limit_n += 2.0 * limit_n;
    sum.excess_n = std::max(sum.excess_n, contact.friction_n.norm() - limit_n);
    sum.all_slip = sum.all_slip && contact.slips;
    sum.all_stick = sum.all_stick && !contact.slips;
    EXPECT_NEAR(contact.friction_n.dot(contact.normal), 0.0, 1e-12 * (1.0 + contact.normal_n));
  }
  return sum;
}

/// A track of a ball over the block.
class BallPath {
 public:
  explicit BallPath(ContactProblem<3>& body) : body_(body), state_(body.rest()) {
    body.note_places(ball(from_), state_);
  }
  const State<3>& go_to(const Vec3& center_m, int steps) {
    for (int step = 1; step <= steps; ++step) {
      body_.set_tool(ball(from_ + (center_m - from_) * step / steps));
      const double before_j = state_.dissipated_j;
      const NewtonReport report = body_.solve(state_);
      EXPECT_TRUE(report.converged) << report.trouble;
      iterations_ += report.iterations;
      EXPECT_GE(state_.dissipated_j, before_j);
      const Sums sum = sums(body_, state_);
      EXPECT_LT(sum.excess_n, 1e-8 * sum.normal_n);
      const Vec3 force_n = body_.observe(state_).force_n;
      work_j_ -= 0.5 * (force_n + force_n_).dot(center_m - from_) / steps;
      force_n_ = force_n;
    }
    from_ = center_m;
    return state_;
  }
  [[nodiscard]] const State<3>& state() const { return state_; }
  [[nodiscard]] double work_j() const { return work_j_; }  ///< of the tool on the body, by the trapezoidal rule
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] const Vec3& force_n() const { return force_n_; }

 private:
  static RigidTool<3> ball(const Vec3& center_m) { return ball_tool<3>(0.01, center_m); }
  ContactProblem<3>& body_;
  State<3> state_;
  Vec3 from_{0.0, 0.0, 0.0101}, force_n_ = Vec3::Zero();
  double work_j_ = 0.0;
  int iterations_ = 0;
};

TEST(Friction, NafemsWedge) {
  const double slope = 0.1, mu = 0.3, angle = std::atan(slope);
  ContactProblem<3> body = block(0.01, 0.3);
  body.set_friction({mu, 1.0, mu}, 1.0);
  const auto flat = std::make_shared<FlatTool>();
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(-angle, Vec3::UnitY()));
  const Vec3 along = tilted * Vec3::UnitX();
  ASSERT_NEAR(along.z() / along.x(), slope, 1e-12);
  State<3> state = body.rest();
  const auto move = [&](const Vec3& place_m) {
    body.set_tool({flat, {place_m, tilted}});
    const NewtonReport report = body.solve(state);
    ASSERT_TRUE(report.converged) << report.trouble;
  };
  const Vec3 pressed_m(0.0, 0.0, -0.0005);
  for (const double share : {-2.0, -0.5, 1.0}) move(share * pressed_m);
  for (const double way_m : {0.001, 0.004, 0.008}) move(pressed_m + way_m * along);
  const std::vector<NodeContact<3>> contacts = body.node_contacts(state);
  ASSERT_GT(contacts.size(), 8u);
  double acting_n = 0.0;
  for (const NodeContact<3>& contact : contacts) acting_n += contact.normal_n;
  for (const NodeContact<3>& contact : contacts) {
    EXPECT_TRUE(contact.slips);
    EXPECT_NEAR(contact.friction_n.norm(), mu * contact.normal_n, 1e-8 * acting_n);
    EXPECT_GT(contact.friction_n.dot(along), 0.0);
  }
  const Observation seen = body.observe(state, 1.0);
  // Friction in the slope's plane: NAFEMS CGS-4, F / G = (tan a + mu) / (1 - mu tan a) = 0.412371, apart from the
  // block's lateral deformation, which changes the friction's direction at single nodes.
  double share = 0.0, normal_n = 0.0;
  for (const NodeContact<3>& contact : contacts) {
    share += contact.friction_n.dot(along) / mu;
    normal_n += contact.normal_n;
  }
  const double mu_along = mu * share / normal_n;
  EXPECT_NEAR(-seen.force_n.x() / seen.force_n.z(), (slope + mu_along) / (1.0 - mu_along * slope), 1e-6);
  EXPECT_NEAR(-seen.force_n.x() / seen.force_n.z(), 0.412371, 0.001 * 0.412371);
  EXPECT_LT(seen.equilibrium_rel, 1e-6);
  EXPECT_EQ(seen.regions.at(0).stuck_share, 0.0);
  RecordProperty("ratio", std::to_string(-seen.force_n.x() / seen.force_n.z()));
}

TEST(Friction, NodesKeepTheLimitsThatSumToTheRegions) {
  const scene::Friction law{1.0, 0.75, 0.25};
  ContactProblem<3> body = block(0.004, 0.45);
  body.set_friction(law, 0.004);
  BallPath ball(body);
  ball.go_to({-0.004, 0.0, 0.008}, 3);
  double largest_share = 0.0;
  bool slid = false;
  for (int step = 1; step <= 5; ++step) {
    const State<3>& state = ball.go_to({-0.004 + 0.0008 * step, 0.0, 0.008}, 1);
    const Sums sum = sums(body, state);
    const double at_rest_n = law.K * std::pow(sum.normal_n, law.beta);
    ASSERT_GT(at_rest_n, law.mu_D * sum.normal_n);
    slid = slid || sum.all_slip;
    EXPECT_NEAR(sum.limit_n / (slid ? law.mu_D * sum.normal_n : at_rest_n), 1.0, 1e-9) << step;
    if (slid) {
      EXPECT_NEAR(sum.friction_n / (law.mu_D * sum.normal_n), 1.0, 1e-6);
    } else {
      largest_share = std::max(largest_share, sum.friction_n / at_rest_n);
    }
  }
  EXPECT_TRUE(slid);
  EXPECT_GT(largest_share, 0.5);
  const Observation seen = body.observe(ball.state(), 0.004);
  EXPECT_LT(seen.equilibrium_rel, 1e-6);
  EXPECT_LT(seen.node_penetration_m, 1e-9);
  EXPECT_LT(seen.regions.at(0).friction_n.x(), 0.0);
  RecordProperty("iterations", ball.iterations());
}

/// A ball pressed into a large cylinder; small strain.
struct Pressed {
  Observation seen;
  int iterations = 0;
};
Pressed press(double poissons_ratio, double coefficient, int steps, double cells = 12.0, double depth = 1e-3) {
  const double R_m = 0.01, d_m = depth * R_m, a_m = std::sqrt(R_m * d_m), L_m = 400.0 * a_m;
  CylinderSpec spec{L_m, L_m, {}};
  spec.grading.growth = 0.4;
  spec.grading.largest_m = 0.25 * L_m;
  spec.grading.discs.push_back({{0.0, L_m}, {0.0, 1.0}, a_m, a_m / cells});
  ContactProblem<2> body(cylinder_mesh(spec), {3e6, poissons_ratio}, scene::Kinematics::small, false, false, 1);
  body.set_friction({coefficient, 1.0, coefficient}, 0.0);
  const auto ball = [&](double time) { return ball_tool<2>(R_m, {0.0, L_m + R_m - time * d_m}); };
  LoadPath<2> path(
      body, [&](double time) { return time > 0.0 ? std::optional(ball(time)) : std::nullopt; }, ball);
  Pressed pressed;
  std::optional<Solved<2>> before;
  Solved<2> current{0.0, body.rest(), false};
  for (int step = 1; step <= steps; ++step) {
    Solved<2> next;
    const AdvanceReport report =
        path.advance(before ? &*before : nullptr, current, static_cast<double>(step) / steps, next, {}, {});
    EXPECT_TRUE(report.converged) << report.last.trouble;
    pressed.iterations += report.newton_iterations;
    before = std::move(current);
    current = std::move(next);
  }
  pressed.seen = body.observe(current.state);
  return pressed;
}

TEST(Friction, AStuckBallIsStifferByMossakovskiisFactor) {
  // dF/dd = 2 E* a C, C = (1 - nu) ln(3 - 4 nu) / (1 - 2 nu): V. I. Mossakovskii, J. Appl. Math. Mech. 27 (1963)
  // 418-427; for a similar process, F ~ d^1.5, this is F = 4/3 E* a d C.
  for (const double nu : {0.0, 0.3}) {
    const Pressed stuck = press(nu, 1e3, 40);
    const double C = (1.0 - nu) * std::log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu);
    // The contact radius changes by whole nodes, an effect of 1 %.
    const double a_m = stuck.seen.contact_radius_m, d_m = 1e-5, E_star_pa = verification::contact_modulus_pa(3e6, nu);
    const double found = stuck.seen.force_n.z() / (4.0 / 3.0 * E_star_pa * a_m * d_m);
    EXPECT_NEAR(found, C, 0.012 * C);
    RecordProperty("C at nu " + std::to_string(nu), std::to_string(found));
  }
}

/// Force on a ball of R = 10 mm pressed 5 mm into a cylinder of 50 x 50 mm of incompressible rubber.
double deep_press_n(std::optional<double> coefficient) {
  CylinderSpec spec{0.05, 0.05, {}};
  spec.grading.growth = 0.5;
  spec.grading.largest_m = 0.0125;
  spec.grading.discs.push_back({{0.0, 0.05}, {0.0, 1.0}, 0.008, 0.0008});
  ContactProblem<2> body(cylinder_mesh(spec), {3e6, 0.5}, scene::Kinematics::finite, false, false, 1);
  if (coefficient) body.set_friction({*coefficient, 1.0, *coefficient}, 0.0);
  State<2> state = body.rest();
  if (coefficient) body.note_places(ball_tool<2>(0.01, {0.0, 0.06}), state);
  constexpr int steps = 20;
  for (int step = 1; step <= steps; ++step) {
    body.set_tool(ball_tool<2>(0.01, {0.0, 0.06 - 0.005 * step / steps}));
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble;
    if (!coefficient) continue;
    for (const NodeContact<2>& contact : body.node_contacts(state)) {
      EXPECT_LE(contact.friction_n.norm(), *coefficient * contact.normal_n + 1e-6);
    }
  }
  return body.observe(state).force_n.z();
}

TEST(Friction, HoldsRubberUnderADeepBall) {
  // An independent program with springs at sticking nodes found 191.18 N without friction and 192.8, 193.6, 194.2 N
  // with mu = 0.3 and stiffer and stiffer springs, until it did not converge; so friction adds slightly more than 1.6
  // %.
  const double without_n = deep_press_n(std::nullopt), some_n = deep_press_n(0.3), stuck_n = deep_press_n(10.0);
  EXPECT_NEAR(without_n, 191.18, 0.002 * 191.18);
  EXPECT_GT(some_n / without_n, 1.016);
  EXPECT_LT(some_n / without_n, 1.025);
  EXPECT_NEAR(stuck_n / some_n, 1.0, 0.002);
  RecordProperty("forces", std::to_string(without_n) + " " + std::to_string(some_n) + " " + std::to_string(stuck_n));
}

TEST(Friction, ConvergesWithTheLoadStep) {
  std::vector<double> forces_n;
  for (const int steps : {3, 6, 12, 24}) {
    const Pressed pressed = press(0.0, 0.2, steps);
    forces_n.push_back(pressed.seen.force_n.z());
  }
  for (std::size_t i = 0; i < forces_n.size(); ++i)
    RecordProperty("n" + std::to_string(i), std::to_string(forces_n[i]));
  EXPECT_LT(std::abs(forces_n[3] - forces_n[2]), 0.7 * std::abs(forces_n[2] - forces_n[1]));
  EXPECT_LT(std::abs(forces_n[3] - forces_n[2]), 1e-3 * forces_n[3]);
}

TEST(Friction, WithoutACoefficientThereIsNone) {
  const Pressed none = press(0.3, 0.0, 3), some = press(0.3, 0.2, 3);
  EXPECT_NEAR(
      none.seen.force_n.z() / verification::hertz(verification::contact_modulus_pa(3e6, 0.3), 0.01, 1e-5).force_n, 1.0,
      0.01);
  EXPECT_EQ(none.seen.dissipated_j, 0.0);
  EXPECT_GT(some.seen.force_n.z(), 1.005 * none.seen.force_n.z());
  EXPECT_GT(some.seen.dissipated_j, 0.0);
}

TEST(Friction, CattaneoAndMindlin) {
  ShiftedBall problem{{3e6, 0.3}, 0.01, 1e-6, 0.3};
  problem.shift_m = 1.25 * 0.3 * 1e-6 * 1.7 / 1.4;
  problem.steps = 5;
  problem.cells_per_radius = 4.0;
  for (const ShiftedBallStep& step : shift_ball(problem)) {
    const double force = step.tangential_n / (problem.friction * step.normal_n);
    const double exact = mindlin_force(problem, step.shift_m);
    EXPECT_NEAR(force, exact, 0.015) << step.shift_m;
    EXPECT_NEAR(stick_radius_of_share(step.stuck_share), mindlin_stick_radius(exact), 0.025) << step.shift_m;
    RecordProperty("s" + std::to_string(step.shift_m * 1e9),
                   std::to_string(force) + " " + std::to_string(exact) + " c/a " +
                       std::to_string(stick_radius_of_share(step.stuck_share)) + " " +
                       std::to_string(mindlin_stick_radius(exact)) + " " + std::to_string(step.newton_iterations));
  }
}

TEST(Friction, ATailBeginsToSlide) {
  // A tool whose width does not bound its contact, pressed by half its radius, so that the contact's wall is steep, and
  // moved on by a quarter of its radius at a time.
  ContactProblem<3> body = block(0.0015, 0.5, 0.006);
  body.set_friction({1.0, 0.75, 0.5}, 0.004);
  const auto tail = std::make_shared<Tail>();
  const auto at = [&](double x_m, double depth_m) {
    return RigidTool<3>(tail, {Vec3(x_m, 0.0, Tail::radius_m - depth_m), Eigen::Quaterniond::Identity()});
  };
  State<3> state = body.rest();
  body.note_places(at(-0.002, -1e-5), state);
  int iterations = 0, most = 0;
  const auto move = [&](double x_m, double depth_m) {
    body.set_tool(at(x_m, depth_m));
    const double before_j = state.dissipated_j;
    const NewtonReport report = body.solve(state);
    ASSERT_TRUE(report.converged) << report.trouble << " at x = " << x_m;
    iterations += report.iterations;
    most = std::max(most, report.iterations);
    EXPECT_GE(state.dissipated_j, before_j);
    const Sums sum = sums(body, state);
    EXPECT_LT(sum.excess_n, 1e-8 * sum.normal_n);
  };
  for (int step = 1; step <= 8; ++step) move(-0.002, 0.00025 * step);
  for (int step = 1; step <= 4; ++step) move(-0.002 + 0.001 * step, 0.002);
  EXPECT_TRUE(sums(body, state).all_slip);
  RecordProperty("iterations", std::to_string(iterations) + " most " + std::to_string(most));
}

TEST(Friction, ALoopDissipatesItsArea) {
  ContactProblem<3> body = block(0.005, 0.45, 0.008);
  body.set_friction({0.3, 1.0, 0.3}, 0.004);
  BallPath ball(body);
  const double z_m = 0.0085;
  ball.go_to({0.0, 0.0, z_m}, 3);
  ball.go_to({0.0015, 0.0, z_m}, 4);
  ball.go_to({-0.0015, 0.0, z_m}, 8);
  const double work_j = ball.work_j(), dissipated_j = ball.state().dissipated_j;
  const double one_way_n = ball.force_n().x();
  ball.go_to({0.0015, 0.0, z_m}, 8);
  EXPECT_NEAR(ball.force_n().x() / -one_way_n, 1.0, 0.01);
  ball.go_to({-0.0015, 0.0, z_m}, 8);
  const double loop_j = ball.work_j() - work_j, lost_j = ball.state().dissipated_j - dissipated_j;
  EXPECT_GT(loop_j, 0.0);
  EXPECT_NEAR(lost_j / loop_j, 1.0, 0.05);
  RecordProperty("loop",
                 std::to_string(loop_j) + " " + std::to_string(lost_j) + " " + std::to_string(ball.iterations()));
}

}  // namespace
}  // namespace touchstone::reference
