// The reported uncertainty must cover the true error, taken from a much finer mesh: in the meridian plane, and in space
// for a scene that can also be solved in the meridian plane.
#include "reference/contact/contact_problem.h"
#include "reference/contact/interior.h"
#include "reference/contact/load_path.h"
#include "reference/mesh/sampling.h"
#include "reference/run/inside.h"
#include "reference/run/model_choice.h"
#include "reference/run/run.h"
#include "reference/solver.h"
#include "reference/verification/closed_forms.h"

#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace touchstone::reference {
namespace {

class UncertaintyBand : public testing::Test {
 protected:
  UncertaintyBand()
      : root_(std::filesystem::temp_directory_path() / ("touchstone-band-" + std::to_string(::getpid()))) {
    scene_ = ball_on_ball_scene({{0.0, 0.0702}, {1.0, 0.0662}}, 6, 0.5);
    scene_.reference = {};
  }
  ~UncertaintyBand() override { std::filesystem::remove_all(root_); }

  Result solved(const std::string& store, double element_size_m, int levels, int dim = 2) {
    scene_.reference.element_size_m = element_size_m;
    scene_.reference.levels = levels;
    points_m_ = scene::tessellate(*scene::body_shape(scene_.body), 200).points_m;
    ModelChoice choice = choose_model(scene_);
    EXPECT_EQ(choice.dim, 2);
    choice.dim = dim;
    return run(scene_, choice, points_m_, {root_ / store, {}, nullptr}, scene::Stopwatch());
  }

  /// The scene in the meridian plane, on a mesh that is finer everywhere.
  Result truth(int level) {
    const ModelChoice choice = choose_model(scene_);
    const Discretisation<2> mesh = level_mesh<2>(scene_, choice, level, {.far_field = 0.4, .inclusions = 1.0});
    points_m_ = scene::tessellate(*scene::body_shape(scene_.body), 200).points_m;
    const SurfaceSampler<2> sampler(mesh, points_m_, true, true);
    ContactProblem<2> problem(mesh, scene_.body.material, scene_.reference.kinematics, true, true, 1);
    const auto body = scene::body_shape(scene_.body);
    LoadPath<2> path(problem, [&](double time_s) -> std::optional<RigidTool<2>> {
      const scene::Pose pose = scene::pose_at(scene_.track, time_s);
      if (scene::rest_depth_m(*body, scene_.tool, pose) <= 0.0) return std::nullopt;
      return RigidTool<2>(choice.tool, pose);
    });
    Solved<2> current{-0.1, problem.rest(), false};
    Result result;
    for (const double time_s : scene::instants_s(scene_)) {
      Solved<2> next;
      if (!path.advance(nullptr, current, time_s, next, {}, {}).converged) throw NotConverged("the finer solution");
      current = std::move(next);
      scene::InstantRecord& instant = result.instants.emplace_back();
      instant.displacement_m = sampler.at_points(current.state.u_m);
      if (current.touching) instant.regions.push_back({.force_n = problem.observe(current.state).force_n});
    }
    Eigen::Matrix3Xd probes_m(3, static_cast<Eigen::Index>(scene_.probes.size()));
    for (Eigen::Index k = 0; k < probes_m.cols(); ++k) probes_m.col(k) = scene_.probes[k].position_m;
    const BodySampler<2> inside(mesh, probes_m, true, true);
    at_probes_ = {
        inside.vectors(current.state.u_m),
        inside.tensors(interior(mesh, scene_.body.material, scene_.reference.kinematics, current.state).stress_pa)};
    return result;
  }

  /// @param widest_rel  limit on the force's uncertainty where the contact is deep: one that is too large would say
  /// nothing
  static void expect_held(const Result& reported, const Result& truth, double widest_rel) {
    double deepest_m = 0.0;
    for (const auto& instant : reported.instants) deepest_m = std::max(deepest_m, instant.depth_m);
    for (std::size_t i = 0; i < reported.instants.size(); ++i) {
      const double error_n = (reported.instants[i].force_n() - truth.instants[i].force_n()).norm();
      EXPECT_LE(error_n, reported.instants[i].force_uncertainty_n) << "instant " << i + 1;
      if (reported.instants[i].depth_m < 0.25 * deepest_m) continue;
      EXPECT_GT(error_n, 0.0);
      EXPECT_LT(reported.instants[i].force_uncertainty_n, widest_rel * truth.instants[i].force_n().norm())
          << "instant " << i + 1;
      // The norm of the uncertainty covers the norm of the error, its largest value the largest error, and most points
      // are within their own uncertainty.
      const Eigen::VectorXd error_m =
          (reported.instants[i].displacement_m - truth.instants[i].displacement_m).colwise().norm().transpose();
      const Eigen::VectorXd& band_m = reported.instants[i].displacement_uncertainty_m;
      const double inside = (error_m.array() <= band_m.array() + 1e-9).cast<double>().mean();
      EXPECT_GT(inside, 0.85) << "instant " << i + 1;
      EXPECT_LE(error_m.maxCoeff(), band_m.maxCoeff()) << "instant " << i + 1;
      EXPECT_LE(error_m.squaredNorm(), band_m.squaredNorm()) << "instant " << i + 1;
    }
  }

  /// A cylinder as wide and as high as that, whose top stands for a half space, in small strain.
  void half_space(double L_m, double poissons_ratio) {
    scene_.body.shape = scene::BodyShape::revolution;
    scene_.body.profile = {{{0.0, 0.0}, {L_m, 0.0}, {L_m, L_m}, {0.0, L_m}}, {}};
    scene_.body.material.poissons_ratio = poissons_ratio;
    scene_.reference.kinematics = scene::Kinematics::small;
    scene_.reference.levels = 3;
  }
  /// From a depth above the surface to a depth below it; the tool's centre is tip_m above its lowest point.
  void press(double height_m, double tip_m, double depth_m, int instants) {
    scene_.track = {{0.0, {{0.0, 0.0, height_m + tip_m + depth_m}, Eigen::Quaterniond::Identity()}},
                    {1.0, {{0.0, 0.0, height_m + tip_m - depth_m}, Eigen::Quaterniond::Identity()}}};
    scene_.compare.instants = instants;
    points_m_ = Eigen::Vector3d(0.0, 0.0, height_m);
  }

  static void expect_half_axes(const scene::ReferenceInstant& instant, const Eigen::Vector2d& exact_m,
                               double widest_rel) {
    const Eigen::Vector2d &seen_m = instant.contact_half_axes_m, &band_m = instant.contact_half_axes_uncertainty_m;
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LE(std::abs(seen_m[axis] - exact_m[axis]), band_m[axis])
          << "depth " << instant.depth_m << ", axis " << axis;
      EXPECT_LT(band_m[axis], widest_rel * exact_m[axis]) << "depth " << instant.depth_m << ", axis " << axis;
      std::printf("depth %.3g m, half axis %.6g m: error %+.3f %%, uncertainty %.3f %%\n", instant.depth_m,
                  exact_m[axis], 100.0 * (seen_m[axis] / exact_m[axis] - 1.0), 100.0 * band_m[axis] / exact_m[axis]);
    }
  }

  std::filesystem::path root_;
  scene::Scene scene_;
  Eigen::Matrix3Xd points_m_;
  PointValues at_probes_;  // of the truth, at the last instant
};

TEST_F(UncertaintyBand, HoldsTheErrorAgainstAFinerSolution) {
  scene_.reference.element_size_m = 0.003;
  const Result exact = truth(4);
  for (const double element_size_m : {0.0030, 0.0022}) {
    SCOPED_TRACE(testing::Message() << "from " << element_size_m << " m");
    expect_held(solved("coarse", element_size_m, 3), exact, 0.05);
  }
}

/// The edge of a flat pin's fillet makes its force oscillate with the mesh.
TEST_F(UncertaintyBand, HoldsItUnderAPin) {
  scene_.body.shape = scene::BodyShape::revolution;
  scene_.body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}}, {}};
  scene_.tool.shape = scene::ToolShape::cylinder;
  scene_.tool.radius_m = 0.006;
  scene_.tool.length_m = 0.03;
  scene_.tool.edge_radius_m = 0.0015;
  scene_.track = {{0.0, {{0.0, 0.0, 0.0551}, Eigen::Quaterniond::Identity()}},
                  {1.0, {{0.0, 0.0, 0.0530}, Eigen::Quaterniond::Identity()}}};
  scene_.compare.instants = 5;
  scene_.reference.element_size_m = 0.003;
  const Result exact = truth(3);
  expect_held(solved("coarse", 0.003, 3), exact, 0.05);
}

/// The increments of friction are of first order, and the meshes' differences do not show them.
TEST_F(UncertaintyBand, HoldsWhatFewLoadStepsDoToFriction) {
  scene_.body.shape = scene::BodyShape::revolution;
  scene_.body.profile = {{{0.0, 0.0}, {0.05, 0.0}, {0.05, 0.05}, {0.0, 0.05}}, {}};
  scene_.body.material.poissons_ratio = 0.49;
  scene_.contact.friction = scene::Friction{.K = 0.3, .beta = 1.0, .mu_D = 0.3};
  scene_.track = {{0.0, {{0.0, 0.0, 0.0605}, Eigen::Quaterniond::Identity()}},
                  {0.7, {{0.0, 0.0, 0.0570}, Eigen::Quaterniond::Identity()}}};
  const auto with_steps = [&](int instants) {
    scene_.compare.instants = instants;
    return solved("steps", 0.0014, 3);
  };
  const Result few = with_steps(4), many = with_steps(22);
  const double error_n = (few.instants.back().force_n() - many.instants.back().force_n()).norm();
  double load_step_rel = 0.0;
  for (const Sensitivity& one : few.sensitivities) {
    if (one.part == "load_step") load_step_rel = one.force_rel;
  }
  EXPECT_GT(error_n, 1e-3 * many.instants.back().force_n().norm());
  EXPECT_LT(error_n, 1.5 * 4.0 / 3.0 * load_step_rel * many.instants.back().force_n().norm());
  EXPECT_LE(error_n, few.instants.back().force_uncertainty_n);
}

TEST_F(UncertaintyBand, HoldsTheErrorAtProbes) {
  scene_.probes = {{"below", {0.0, 0.0, 0.057}},
                   {"beside", {0.003, 0.002, 0.055}},
                   {"deep", {0.0, 0.0, 0.03}},
                   {"surface", {0.01, 0.0, 0.03 + std::sqrt(8e-4)}}};
  scene_.reference.element_size_m = 0.003;
  (void)truth(4);
  const PointValues exact = at_probes_;
  const Result coarse = solved("coarse", 0.003, 3);
  const ProbeInstant reported = inside(scene_, coarse, root_ / "coarse")->probes().back();
  const Eigen::Matrix<double, 9, Eigen::Dynamic> error_pa = reported.values.stress_pa - exact.stress_pa;
  const Eigen::Matrix3Xd error_m = reported.values.displacement_m - exact.displacement_m;
  for (Eigen::Index k = 0; k < error_m.cols(); ++k) {
    const std::string& where = scene_.probes[static_cast<std::size_t>(k)].name;
    EXPECT_LE(error_m.col(k).norm(), reported.displacement_uncertainty_m[k]) << where;
    EXPECT_LE(error_pa.col(k).norm(), reported.stress_uncertainty_pa[k]) << where;
    EXPECT_LE(std::abs(pressure_pa(error_pa)[k]), reported.pressure_uncertainty_pa()[k]) << where;
  }
  // An uncertainty that is too large would say nothing.
  EXPECT_LT(reported.stress_uncertainty_pa[0], 0.2 * exact.stress_pa.col(0).norm());
}

/// The stress on the axis below Hertz's contact. The half space is a cylinder 3000 contact radii wide and high.
TEST_F(UncertaintyBand, HoldsTheClosedFormOfTheStressBelowAContact) {
  const double depth_m = 2e-6, R_m = scene_.tool.radius_m;
  scene_.body.material = {3e6, 0.3};
  const verification::Indentation exact = verification::hertz(scene_.body.material.contact_modulus_pa(), R_m, depth_m);
  const double a_m = exact.contact_radius_m, L_m = 3000.0 * a_m, peak_pa = verification::hertz_peak_pressure_pa(exact);
  half_space(L_m, 0.3);
  press(L_m, R_m, depth_m, 2);
  for (const double below : {0.2, 0.5, 1.0, 1.5, 3.0}) {
    scene_.probes.push_back({std::to_string(below), {0.0, 0.0, L_m - below * a_m}});
  }
  const Result result = solve(scene_, points_m_, {root_ / "hertz", {}, nullptr});
  const ProbeInstant reported = inside(scene_, result, root_ / "hertz")->probes().back();
  for (Eigen::Index k = 0; k < reported.values.stress_pa.cols(); ++k) {
    const double z_m = L_m - scene_.probes[static_cast<std::size_t>(k)].position_m.z();
    const double zz_pa = reported.values.stress_pa(8, k) - verification::hertz_axis_stress_zz_pa(exact, z_m);
    const double rr_pa = reported.values.stress_pa(0, k) - verification::hertz_axis_stress_rr_pa(exact, 0.3, z_m);
    const double band_pa = reported.stress_uncertainty_pa[k];
    EXPECT_LE(std::abs(zz_pa), band_pa) << "z/a = " << z_m / a_m << ", largest pressure " << peak_pa;
    EXPECT_LE(std::abs(rr_pa), band_pa) << "z/a = " << z_m / a_m << ", largest pressure " << peak_pa;
    EXPECT_LT(band_pa, 0.05 * peak_pa) << "z/a = " << z_m / a_m;
    std::printf("z/a = %g: errors %+.3f %% and %+.3f %% of the largest pressure, uncertainty %.3f %%\n", z_m / a_m,
                100.0 * zz_pa / peak_pa, 100.0 * rr_pa / peak_pa, 100.0 * band_pa / peak_pa);
  }
}

TEST_F(UncertaintyBand, HoldsTheRadiusOfHertzsContact) {
  const double depth_m = 2e-6, R_m = scene_.tool.radius_m, L_m = 3000.0 * std::sqrt(R_m * depth_m);
  for (const double poissons_ratio : {0.0, 0.5}) {
    half_space(L_m, poissons_ratio);
    press(L_m, R_m, depth_m, 4);
    const Result result = solve(scene_, points_m_, {root_ / "hertz-radius", {}, nullptr});
    for (const std::size_t instant : {2, 3}) {
      const double a_m = std::sqrt(R_m * depth_m * (instant == 2 ? 1.0 / 3.0 : 1.0));
      expect_half_axes(result.instants[instant], {a_m, a_m}, 0.05);
    }
    EXPECT_EQ(result.instants[0].contact_half_axes_m, Eigen::Vector2d::Zero());
  }
}

/// The contact's edge lies on the fillet: with a sharp rim it would be at the rim.
TEST_F(UncertaintyBand, HoldsTheRadiusUnderAFlatPunch) {
  const double R_m = 0.001, e_m = 0.25 * R_m, a_m = 0.92 * R_m, L_m = 3000.0 * R_m;
  scene_.tool.shape = scene::ToolShape::cylinder;
  scene_.tool.radius_m = R_m;
  scene_.tool.length_m = 0.004;
  scene_.tool.edge_radius_m = e_m;
  half_space(L_m, 0.3);
  press(L_m, 0.002, verification::rounded_punch(scene_.body.material.contact_modulus_pa(), R_m - e_m, e_m, a_m).depth_m,
        2);
  const Result result = solve(scene_, points_m_, {root_ / "punch-radius", {}, nullptr});
  expect_half_axes(result.instants.back(), {a_m, a_m}, 0.05);
}

/// Hertz's ellipse for the force that the reference finds itself: the body is no half space.
TEST_F(UncertaintyBand, HoldsTheHalfAxesOfAnEllipse) {
  scene_.body.shape = scene::BodyShape::ellipsoid;
  scene_.body.semi_axes_m = {0.06, 0.02, 0.03};
  scene_.tool.radius_m = 0.05;
  scene_.reference.kinematics = scene::Kinematics::small;
  scene_.reference.levels = 3;
  press(0.06, 0.05, 2e-5, 2);  // the ellipsoid stands on z = 0
  const Result result = solve(scene_, points_m_, {root_ / "ellipse", {}, nullptr});
  EXPECT_EQ(result.model, "quarter 3D u-p small strain");
  const auto [long_m, short_m] =
      verification::hertz_semi_axes_m(scene_.body.material.contact_modulus_pa(), 1.0 / (1.0 / 0.05 + 0.03 / 0.0036),
                                      1.0 / (1.0 / 0.05 + 0.03 / 0.0004), result.instants.back().force_n().z());
  EXPECT_GT(long_m, 2.0 * short_m);
  expect_half_axes(result.instants.back(), {long_m, short_m}, 0.07);  // four cells to the short one
}

TEST_F(UncertaintyBand, HoldsTheErrorInSpace) {
  scene_.track = {{0.0, {{0.0, 0.0, 0.0690}, Eigen::Quaterniond::Identity()}},
                  {1.0, {{0.0, 0.0, 0.0662}, Eigen::Quaterniond::Identity()}}};
  scene_.compare.instants = 2;
  scene_.reference.element_size_m = 0.003;
  const Result exact = truth(3);
  const Result reported = solved("space", 0.008, 3, 3);
  EXPECT_EQ(reported.model, "quarter 3D u-p finite strain");
  expect_held(reported, exact, 0.10);
}

}  // namespace
}  // namespace touchstone::reference
