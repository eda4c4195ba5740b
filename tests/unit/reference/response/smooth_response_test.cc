// The smooth response against a point load on a mesh, which is the same displacement away from the load.
#include "reference/response/smooth_response.h"

#include "reference/contact/contact_problem.h"
#include "reference/mesh/inclusions.h"
#include "reference/mesh/mesh.h"
#include "reference/response/prepare.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/response/point_load.h"
#include "support/press.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::reference {
namespace {

using scene::Vec3;

constexpr SmoothResponseOptions coarse{.cells = 5.0};

scene::Scene small_scene(double nu) {
  scene::Scene scene = test::ball_on_cube();
  scene.body.material.poissons_ratio = nu;
  scene.track = {{0.0, test::pressed(-0.001, 0.006)}, {1.0, test::pressed(0.002, 0.006)}};
  scene.fast.triangles = 200;
  return scene;
}

/// Displacement at the rest points by a force of 1 N on the node at a place of the top.
Eigen::Matrix3Xd by_a_node(const scene::Body& body, const Vec3& p_m, const Vec3& direction,
                           const std::vector<int>& nodes, ContactProblem<3>& problem) {
  const Discretisation<3>& mesh = problem.mesh();
  Eigen::Index node = 0;
  EXPECT_LT((mesh.points_m.colwise() - p_m).colwise().norm().minCoeff(&node), 1e-9 * body.size_m.x());
  const auto u_m = problem.linear_displacements_m({{static_cast<int>(node), direction}}).front();
  return u_m(Eigen::all, nodes);
}

void expect_the_same_far_away(const scene::Body& body, double tolerance) {
  const double edge_m = body.size_m.x();
  BlockSpec spec;
  spec.lower_m = {-0.5 * edge_m, -0.5 * edge_m, 0.0};
  spec.upper_m = {0.5 * edge_m, 0.5 * edge_m, edge_m};
  spec.grading.largest_m = edge_m / 8.0;
  refine_at_inclusions(body, 4.0, spec.grading);
  Discretisation<3> mesh = block_mesh(spec);
  embed_inclusions(body, mesh);
  ContactProblem<3> problem(mesh, body.material, scene::Kinematics::small, false, false);
  // A node of that mesh, and the nodes of the surface away from it.
  const Vec3 p_m(0.25 * edge_m, 0.0, edge_m);
  std::vector<int> nodes;
  for (const int node : problem.contact_nodes()) {
    if ((mesh.points_m.col(node) - p_m).norm() > 0.4 * edge_m) nodes.push_back(node);
  }
  scene::LoadGrid grid;
  grid.middle_m = p_m;
  grid.counts = {1, 1};
  grid.spacing_m = {0.003, 0.003};
  grid.points_m = p_m;
  grid.normals = Vec3::UnitZ();
  const Eigen::Matrix3Xd points_m = mesh.points_m(Eigen::all, nodes);
  const scene::Response response =
      smooth_response(body, grid, points_m, {.cells = coarse.cells, .loads = {.friction = true, .ball = true}});
  const Eigen::Matrix<double, 3, 2> along = grid.along(0);
  const std::array loads{scene::PointLoad{p_m, Vec3::UnitZ(), 1.0},
                         scene::PointLoad{p_m, Vec3::UnitZ(), 0.0, along.col(0)},
                         scene::PointLoad{p_m, Vec3::UnitZ(), 0.0, along.col(1)}};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const scene::PointLoad& load = loads[static_cast<std::size_t>(k)];
    Eigen::Matrix3Xd u_m = response.smooth_m_per_n.col(k).reshaped(points_m.cols(), 3).transpose().cast<double>();
    for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
      u_m.col(i) += scene::half_space_displacement_m(load, body.material, points_m.col(i));
    }
    const Eigen::Matrix3Xd expected_m = by_a_node(body, p_m, load.along_n - load.force_n * load.normal, nodes, problem);
    EXPECT_LT((u_m - expected_m).norm(), tolerance * expected_m.norm()) << body.material.poissons_ratio << ' ' << k;
  }
  // A double force is four forces on nodes beside it.
  const double apart_m = edge_m / 16.0;
  Eigen::Matrix3Xd u_m =
      response.smooth_m_per_n.col(response.apart(0)).reshaped(points_m.cols(), 3).transpose().cast<double>();
  Eigen::Matrix3Xd expected_m = Eigen::Matrix3Xd::Zero(3, points_m.cols());
  for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
    u_m.col(i) +=
        scene::half_space_displacement_m({p_m, Vec3::UnitZ(), 0.0, Vec3::Zero(), 1.0}, body.material, points_m.col(i));
  }
  for (const Vec3& out : {Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, -1.0, 0.0)}) {
    expected_m += by_a_node(body, p_m + apart_m * out, 0.5 / apart_m * out, nodes, problem);
  }
  EXPECT_LT((u_m - expected_m).norm(), 4.0 * tolerance * expected_m.norm()) << body.material.poissons_ratio;
}

TEST(SmoothResponse, IsTheBodysOwnAwayFromTheLoad) {
  for (const double nu : {0.0, 0.3, 0.5}) expect_the_same_far_away(small_scene(nu).body, 0.02);
}

TEST(SmoothResponse, ADoubleForceOnACurvedFaceIsSmoothWhereverItIs) {
  scene::Scene scene = small_scene(0.5);
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.03;
  scene.body.support_height_m = 0.005;
  scene.track.back() = {1.0, test::pressed(0.002, 0.0013, 0.0007)};
  const scene::LoadGrid grid = scene::load_grid(scene).grid.value();
  const Eigen::Matrix3Xd points_m = scene::tessellate(*scene::body_shape(scene.body), 600).points_m;
  const scene::Response response =
      smooth_response(scene.body, grid, points_m, {.cells = coarse.cells, .loads = {.ball = true}});
  Eigen::VectorXd sizes(grid.count());
  for (int k = 0; k < grid.count(); ++k) sizes[k] = response.smooth_m_per_n.col(response.apart(k)).norm();
  EXPECT_LT(sizes.maxCoeff(), 1.5 * sizes.minCoeff());
}

TEST(SmoothResponse, KnowsInclusions) {
  scene::Body body = small_scene(0.5).body;
  scene::Inclusion soft;
  soft.shape = scene::BodyShape::sphere;
  soft.radius_m = 0.015;
  soft.center_m = Vec3(0.0, 0.0, 0.03);
  soft.material = {1e5, 0.33};
  body.inclusions = {soft};
  expect_the_same_far_away(body, 0.04);
  body.material.poissons_ratio = 0.3;
  body.inclusions.front().material = {5e7, 0.4};
  expect_the_same_far_away(body, 0.04);
  body.inclusions.front().material.poissons_ratio = 0.5;
  EXPECT_THROW(
      (void)smooth_response(body, scene::load_grid(small_scene(0.3)).grid.value(), Eigen::Matrix3Xd(3, 0), coarse),
      scene::InputError);
}

TEST(SmoothResponse, IsReciprocalAndTiltsAsItsPlaceChangesIt) {
  const scene::Scene scene = small_scene(0.5);
  const scene::LoadGrid grid = scene::load_grid(scene).grid.value();
  const int n = grid.count();
  const scene::Response response =
      smooth_response(scene.body, grid, grid.points_m, {.cells = coarse.cells, .loads = {.friction = true}});
  // u_z of point i under load j.
  const Eigen::MatrixXd down_m = response.smooth_m_per_n.bottomLeftCorner(n, n).cast<double>();
  const double size_m = down_m.cwiseAbs().maxCoeff();
  EXPECT_LT((down_m - down_m.transpose()).cwiseAbs().maxCoeff(), 5e-3 * size_m);
  // Where load and point are one: C and its slope, half of which is the tilt under a load that stays.
  for (int k = 0; k < n; ++k) EXPECT_NEAR(response.own_m_per_n(2, k), down_m(k, k), 1e-3 * size_m);
  const double slope = (response.own_m_per_n(2, 5) - response.own_m_per_n(2, 3)) / (2.0 * grid.spacing_m[0]);
  EXPECT_NEAR(response.tilt_per_n(0, 4), 0.5 * slope, 0.05 * std::abs(slope));
  EXPECT_NEAR(response.tilt_per_n(1, 4), 0.0, 1e-3 * std::abs(slope));
  // A load between four of the places, interpolated: nearer places are better.
  EXPECT_LT(response.interpolation_rel, 0.01);
  scene::Scene wide = scene;
  wide.track.back() = {1.0, test::pressed(0.002, -0.018)};
  scene::LoadGrid apart = scene::load_grid(wide).grid.value();
  apart.counts = {3, 3};
  apart.spacing_m = {0.018, 0.018};
  apart.points_m = (apart.middle_m.replicate(1, 9)).eval();
  for (int k = 0; k < 9; ++k) apart.points_m.col(k) += 0.018 * Vec3(k % 3 - 1, k / 3 - 1, 0.0);
  apart.normals = Vec3::UnitZ().replicate(1, 9);
  const scene::Response coarser = smooth_response(scene.body, apart, grid.points_m, {.cells = coarse.cells});
  EXPECT_GT(coarser.interpolation_rel, 3.0 * response.interpolation_rel);
  // What a load against the normal does sideways, one sideways does against the normal.
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Matrix3d own = Eigen::Matrix3d(
        {{-response.own_m_per_n(0, k), response.own_m_per_n(0, n + 2 * k), response.own_m_per_n(0, n + 2 * k + 1)},
         {-response.own_m_per_n(1, k), response.own_m_per_n(1, n + 2 * k), response.own_m_per_n(1, n + 2 * k + 1)},
         {-response.own_m_per_n(2, k), response.own_m_per_n(2, n + 2 * k), response.own_m_per_n(2, n + 2 * k + 1)}});
    const Eigen::Matrix3d by_direction = own(Eigen::all, {1, 2, 0});
    EXPECT_LT((by_direction - by_direction.transpose()).norm(), 2e-2 * by_direction.norm()) << k;
    EXPECT_GT(by_direction.diagonal().minCoeff(), 0.0) << k;
  }
}

TEST(PrepareResponse, KeepsAndReadsBack) {
  const compare::testing::TemporaryFolder folder;
  const scene::Scene scene = small_scene(0.3);
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  int begun = 0;
  Eigen::Index done = 0;
  const auto prepare = [&] {
    return prepare_response(scene, surface, folder.path(), [&](const SmoothProgress& now) {
      if (now.next == SmoothProgress::Next::mesh) ++begun;
      done = now.first.done;
    });
  };
  const Prepared first = prepare(), second = prepare();
  EXPECT_TRUE(first.computed);
  EXPECT_FALSE(second.computed);
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(done, first.response.own_m_per_n.cols());
  EXPECT_EQ(first.file, second.file);
  EXPECT_EQ(first.response.smooth_m_per_n, second.response.smooth_m_per_n);
  EXPECT_EQ(first.response.own_m_per_n, second.response.own_m_per_n);
  // A damaged file is computed anew, to the same bits.
  std::string bytes = scene::read_file(first.file).value();
  const std::string before = bytes;
  bytes.resize(bytes.size() / 2);
  scene::write_file(first.file, bytes);
  EXPECT_TRUE(prepare().computed);
  EXPECT_EQ(scene::read_file(first.file).value(), before);
  scene::Scene far = scene;
  for (scene::Waypoint& waypoint : far.track) waypoint.pose.position_m.z() += 0.1;
  EXPECT_THROW((void)prepare_response(far, surface, folder.path()), scene::InputError);
}

TEST(PrepareResponse, GoesOnWithTheColumnsOfAStoppedRunToTheSameBits) {
  const compare::testing::TemporaryFolder folder;
  const scene::Scene scene = small_scene(0.5);
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  struct Stop {};
  std::vector<Eigen::Index> done;  // at each call
  const auto prepare = [&](const std::filesystem::path& store, Eigen::Index stop_at) {
    done.clear();
    return prepare_response(scene, surface, store, [&](const SmoothProgress& now) {
      done.push_back(now.first.done);
      if (now.next == SmoothProgress::Next::column && now.first.done == stop_at) throw Stop();
    });
  };
  const std::string whole = scene::read_file(prepare(folder.path() / "whole", 0).file).value();
  const auto all_from = [&](Eigen::Index first) {
    std::vector<Eigen::Index> out{first};
    for (Eigen::Index i = first; i <= scene::load_kinds(scene).columns(9); ++i) out.push_back(i);
    return out;
  };
  EXPECT_EQ(done, all_from(0));
  const auto store = folder.path() / "stopped";
  const auto unfinished = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(store / "response")) {
      if (entry.path().extension() == ".unfinished") return entry.path();
    }
    return std::filesystem::path();
  };
  EXPECT_THROW((void)prepare(store, 2), Stop);
  EXPECT_THROW((void)prepare(store, 5), Stop);
  EXPECT_EQ(done, (std::vector<Eigen::Index>{2, 2, 3, 4, 5}));
  const std::string five = scene::read_file(unfinished()).value();
  // Damaged, the columns are computed again: a bit of a number, the count, cut short.
  std::string bit = five, count = five;
  bit[five.size() - 1] ^= 1;
  count[0] = '6';
  for (const std::string& damaged : {bit, count, five.substr(0, five.size() / 2)}) {
    scene::write_file(unfinished(), damaged);
    EXPECT_THROW((void)prepare(store, 1), Stop);
    EXPECT_EQ(done, (std::vector<Eigen::Index>{0, 0, 1}));
  }
  scene::write_file(unfinished(), five);
  EXPECT_EQ(scene::read_file(prepare(store, 0).file).value(), whole);
  EXPECT_EQ(done, all_from(5));
  EXPECT_EQ(unfinished(), "");
}

}  // namespace
}  // namespace touchstone::reference
