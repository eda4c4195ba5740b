// The precomputed compliance against the reference's own small-strain solution of the same discrete problem.
#include "compare/model/linear_contact.h"

#include "compare/model/growing_cholesky.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "scene/shape/surface.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <cmath>
#include <random>

namespace touchstone::compare {
namespace {

const std::string scenes = source_folder() + "/meshes/scenes/";

scene::Scene load(const std::string& name, std::vector<std::string> settings) {
  settings.insert(settings.end(), {"reference.kinematics=small", "reference.levels=1", "fast.triangles=200"});
  return scene::load_scene(scenes + name, settings);
}

/// Both solutions at every instant of a scene.
struct Pair {
  reference::Result reference;
  std::vector<scene::Vec3> force_n;
  std::vector<Eigen::Matrix3Xd> displacement_m;
};

Pair solve_both(const scene::Scene& scene, bool whole_body) {
  const testing::TemporaryFolder folder;
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  reference::Options options;
  options.store = folder.path();
  Pair out{reference::solve(scene, surface.points_m, options), {}, {}};
  reference::LinearResponseOptions response_options;
  response_options.whole_body = whole_body;
  LinearContact contact(reference::linear_response(scene, surface.points_m, response_options), scene.tool);
  for (const scene::InstantRecord& instant : out.reference.instants) {
    contact.step(instant.tool);
    EXPECT_TRUE(contact.solved());
    out.force_n.push_back(contact.force_n());
    out.displacement_m.push_back(contact.displacement_m());
  }
  return out;
}

void expect_equal(const Pair& both, double force_rel, double shape_rel) {
  double peak_n = 0.0;
  for (std::size_t t = 0; t < both.force_n.size(); ++t) {
    const scene::InstantRecord& instant = both.reference.instants[t];
    const double force_n = instant.force_n().norm();
    peak_n = std::max(peak_n, force_n);
    EXPECT_LE((both.force_n[t] - instant.force_n()).norm(), force_rel * force_n) << t;
    EXPECT_LE((both.displacement_m[t] - instant.displacement_m).norm(), shape_rel * instant.displacement_m.norm()) << t;
  }
  EXPECT_GT(peak_n, 1.0);
}

// For an incompressible material the volume may change as far as the tangent's bulk modulus allows, see MixedMaterial.
// A compressible material has no such effect, and single precision of the shape remains.
TEST(LinearContact, SolvesTheReferencesOwnProblemOfSmallStrain) {
  expect_equal(solve_both(load("ball-on-cube-press.toml", {"compare.instants=5", "body.material.poissons_ratio=0.3",
                                                           "reference.element_size_m=0.006"}),
                          false),
               1e-7, 1e-6);
  expect_equal(
      solve_both(load("ball-on-cube-press.toml", {"compare.instants=3", "reference.element_size_m=0.006"}), false),
      5e-4, 5e-4);
}

TEST(LinearContact, SolvesTheRingsOfABodyOfRevolution) {
  expect_equal(
      solve_both(load("sphere-on-sphere-body.toml", {"compare.instants=5", "body.material.poissons_ratio=0.3"}), true),
      1e-6, 1e-6);
}

// The whole body gives the quarter's result if the tool is at its centre; away from it no symmetry applies.
TEST(LinearContact, KnowsTheWholeBody) {
  const std::vector<std::string> settings = {"compare.instants=3", "reference.element_size_m=0.006",
                                             "body.material.poissons_ratio=0.3"};
  expect_equal(solve_both(load("ball-on-cube-press.toml", settings), true), 1e-3, 1e-3);
  std::vector<std::string> aside = settings;
  aside.insert(aside.end(), {"track[0].position_m[0]=0.009", "track[1].position_m[0]=0.009",
                             "track[0].position_m[1]=-0.004", "track[1].position_m[1]=-0.004"});
  expect_equal(solve_both(load("ball-on-cube-press.toml", aside), true), 1e-6, 1e-6);
}

// Hertz's closed form is valid for depths that are small beside the ball and the body. E* = E / (1 - nu^2).
TEST(LinearContact, GivesHertzsForce) {
  const scene::Scene scene = load("hertz-sphere.toml", {"compare.instants=4"});
  const Pair both = solve_both(scene, true);
  for (std::size_t t = 0; t < both.force_n.size(); ++t) {
    const double depth_m = both.reference.instants[t].depth_m;
    const double hertz_n =
        4.0 / 3.0 * scene.body.material.contact_modulus_pa() * std::sqrt(scene.tool.radius_m) * std::pow(depth_m, 1.5);
    EXPECT_NEAR(both.force_n[t].z(), hertz_n, 0.03 * hertz_n) << depth_m;
  }
}

// The ball reaches below the top, where the normals of the cube's sides pass through it from behind.
TEST(LinearContact, SeesNoToolThroughTheBody) {
  const scene::Scene scene = load("ball-on-cube-press.toml", {"compare.instants=3", "reference.element_size_m=0.006"});
  const reference::LinearResponse response =
      reference::linear_response(scene, scene::tessellate(*scene::body_shape(scene.body), 200).points_m);
  EXPECT_GT(response.nodes_m.cols(), 10);
  EXPECT_LT((response.nodes_m.row(2).array() - 0.06).abs().maxCoeff(), 1e-9) << "all on the top";
  LinearContact contact(response, scene.tool);
  constexpr double depth_m = 0.005;
  contact.step({{0.0, 0.0, 0.065}, Eigen::Quaterniond::Identity()});
  const double hertz_n =
      4.0 / 3.0 * scene.body.material.contact_modulus_pa() * std::sqrt(scene.tool.radius_m) * std::pow(depth_m, 1.5);
  EXPECT_NEAR(contact.force_n().z(), hertz_n, 0.15 * hertz_n);
}

TEST(LinearContact, LeavesNoNodeInsideTheToolNorPulled) {
  const scene::Scene scene = load("ball-on-cube-press.toml", {"compare.instants=4", "reference.element_size_m=0.006"});
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), 200);
  LinearContact contact(reference::linear_response(scene, surface.points_m), scene.tool);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> aside_m(-0.002, 0.002), height_m(0.0652, 0.0702);
  for (int k = 0; k < 200; ++k) {
    contact.step({{aside_m(random), aside_m(random), height_m(random)}, Eigen::Quaterniond::Identity()});
    ASSERT_TRUE(contact.solved());
    EXPECT_GE(contact.gap_m().minCoeff(), -1e-12);
    EXPECT_GE(contact.node_force_n().minCoeff(), 0.0);
    for (int i = 0; i < contact.nodes(); ++i)
      EXPECT_TRUE(contact.node_force_n()[i] == 0.0 || contact.gap_m()[i] == 0.0);
  }
  contact.step({{0.0, 0.0, 0.09}, Eigen::Quaterniond::Identity()});
  EXPECT_EQ(contact.force_n(), scene::Vec3::Zero());
  EXPECT_EQ(contact.displacement_m().norm(), 0.0);
}

TEST(LinearContact, RefusesFrictionAndATrackThatTouchesNothing) {
  const Eigen::Matrix3Xd none(3, 0);
  EXPECT_THROW((void)reference::linear_response(load("ball-on-cube-slide.toml", {}), none), scene::InputError);
  EXPECT_THROW((void)reference::linear_response(
                   load("ball-on-cube-press.toml", {"track[1].position_m[2]=0.0702", "compare.instants=2"}), none),
               scene::InputError);
}

TEST(GrowingCholesky, FollowsWhatJoinsAndLeaves) {
  const Eigen::Index n = 30;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
  const Eigen::MatrixXd K = A * A.transpose() + Eigen::MatrixXd::Identity(n, n);
  GrowingCholesky factor(K);
  for (int change = 0; change < 500; ++change) {
    const auto size = static_cast<Eigen::Index>(factor.part().size());
    const Eigen::Index at = std::uniform_int_distribution<Eigen::Index>(0, n - 1)(random);
    const auto found = std::find(factor.part().begin(), factor.part().end(), at);
    if (found == factor.part().end()) {
      ASSERT_TRUE(factor.add(at));
    } else {
      factor.remove(found - factor.part().begin());
    }
    const std::vector<Eigen::Index>& part = factor.part();
    ASSERT_EQ(std::abs(static_cast<Eigen::Index>(part.size()) - size), 1);
    if (part.empty()) continue;
    const Eigen::VectorXd b =
        Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(part.size()), [&] { return normal(random); });
    Eigen::VectorXd x = b;
    factor.solve(x);
    EXPECT_LT((K(part, part) * x - b).norm(), 1e-10 * b.norm() * K.norm()) << change;
  }
  const std::vector<Eigen::Index> part = {7, 3, 21, 4};
  ASSERT_TRUE(factor.assign(part));
  ASSERT_TRUE(factor.add(11));
  factor.remove(1);
  const std::vector<Eigen::Index> left = {7, 21, 4, 11};
  EXPECT_EQ(factor.part(), left);
  const Eigen::Vector4d b(1.0, -2.0, 3.0, 0.5);
  Eigen::VectorXd x = b;
  factor.solve(x);
  EXPECT_LT((K(left, left) * x - b).norm(), 1e-10 * K.norm());
  const Eigen::MatrixXd singular = Eigen::MatrixXd::Ones(2, 2);
  GrowingCholesky cannot(singular);
  EXPECT_TRUE(cannot.add(0));
  EXPECT_FALSE(cannot.add(1));
  EXPECT_EQ(cannot.part().size(), 1u);
  EXPECT_FALSE(cannot.assign({0, 1}));
}

}  // namespace
}  // namespace touchstone::compare
