// The catalogue of extremes: whatever the scene and the pose, no NaN, no force beyond the law's, no torn surface.
#include "fast/step.h"
#include "unit/fast/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

namespace touchstone::fast {
namespace {

using scene::BodyShape;
using scene::Formulation;
using scene::Vec3;

/// A coarse surface, since every vertex is looked at after every step.
scene::Scene coarse(scene::Scene scene) {
  scene.fast.triangles = 600;
  return scene;
}

class Extremes : public testing::TestWithParam<std::tuple<BodyShape, Formulation>> {
 protected:
  scene::Scene scene =
      coarse(std::get<0>(GetParam()) == BodyShape::box ? test::ball_on_cube(std::get<1>(GetParam()))
                                                       : test::ball_on_sphere(std::get<1>(GetParam())));
};

struct Rig {
  explicit Rig(const scene::Scene& scene) : model(scene), state(model) {}

  StepStatus to(const scene::Pose& pose) {
    const StepStatus status = step(model, pose, state);
    expect_sane();
    return status;
  }
  void expect_sane() const {
    const ContactRegion& region = state.regions[0];
    const double widest_m = (model.body->bounds().upper_m - model.body->bounds().lower_m).norm();
    ASSERT_TRUE(region.force.force_n.allFinite());
    ASSERT_TRUE(region.force.torque_nm.allFinite());
    ASSERT_TRUE(region.origin.p0_W_m.allFinite());
    ASSERT_LE(region.force.magnitude_n, model.law.force_n(depth_limit_rel * widest_m) * (1.0 + 1e-9));
    ASSERT_GE(region.force.magnitude_n, 0.0);
    ASSERT_NEAR(region.d.norm(), 1.0, 1e-9);
    ASSERT_LE(region.displacement_m.norm(), depth_limit_rel * widest_m);
    for (const Vec3& F_i : state.regions[0].ends.force_n) ASSERT_TRUE(F_i.allFinite());
    for (const Vec3& u_i : state.regions[0].ends.displacement_m)
      ASSERT_LE(u_i.norm(), region.displacement_m.norm() * (1.0 + 1e-9));
    for (std::size_t v = 0; v < model.rest.vertex_count(); ++v) {
      const Vec3 u(state.field.displacement_m[0][v], state.field.displacement_m[1][v],
                   state.field.displacement_m[2][v]);
      const Vec3 n(state.field.normal[0][v], state.field.normal[1][v], state.field.normal[2][v]);
      ASSERT_TRUE(u.allFinite());
      ASSERT_LE(u.norm(), 2.0 * region.displacement_m.norm() * largest_factor + 1e-9);
      ASSERT_NEAR(n.norm(), 1.0, 1e-5);
    }
  }

  FastModel model;
  FastState state;
  double largest_factor = 1.0;  ///< of the local factor, beyond 1 only for a C_n past its limit
};

TEST_P(Extremes, TouchingIsNoForce) {
  Rig s(scene);
  const double top_m = s.model.body->bounds().upper_m.z() + scene.tool.radius_m;
  s.to(test::at(0.0, 0.0, top_m + 0.001));
  s.to(test::at(0.0, 0.0, top_m));
  EXPECT_EQ(s.state.regions[0].force.magnitude_n, 0.0);
  for (double depth_m = 1e-3; depth_m > 1e-18; depth_m /= 10.0) s.to(test::at(0.0, 0.0, top_m - depth_m));
  EXPECT_LT(s.state.regions[0].force.magnitude_n, 1e-9);
}

TEST_P(Extremes, ThroughTheWholeBodyAndOut) {
  Rig s(scene);
  for (int i = 0; i <= 100; ++i) s.to(test::at(0.003, 0.0, 0.08 - 0.001 * i));
  EXPECT_FALSE(s.state.in_contact());
}

TEST_P(Extremes, ToolLargerThanTheBody) {
  scene.tool.radius_m = 0.048;
  Rig s(scene);
  for (int i = 0; i <= 60; ++i) s.to(test::at(0.0, 0.0, 0.12 - 0.002 * i));
}

TEST_P(Extremes, StartsInTheMiddleOfTheBody) {
  Rig s(scene);
  s.to(test::at(0.0, 0.0, 0.03));
  EXPECT_TRUE(s.state.in_contact());
  s.to(test::at(1e-12, 0.0, 0.03));
}

TEST_P(Extremes, ContactOnCornersEdgesAnchorsAndTheSupport) {
  Rig s(scene);
  for (const Vec3& out : {Vec3(1, 1, 1), Vec3(1, -1, 1), Vec3(1, 0, 1), Vec3(1, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0),
                          Vec3(0, 0, -1), Vec3(1, 0, -1), Vec3(1, 1, -1), Vec3(1e-9, 0, 1)}) {
    // From far off straight towards the centre, in steps and at once.
    for (int i = 0; i <= 40; ++i)
      s.to({Vec3(0.0, 0.0, 0.03) + (0.065 - 0.001 * i) * out.normalized() * out.lpNorm<1>() / out.norm(),
            test::tilted()});
    s.to(test::at(0.0, 0.0, 1.0));
    s.to({Vec3(0.0, 0.0, 0.03) + 0.038 * out.normalized(), test::tilted()});
    s.to(test::at(0.0, 0.0, 1.0));
  }
  // Exactly over an anchor point, an edge, and along the bottom rim.
  for (const Vec3& place :
       {Vec3(0.03, 0.03, 0.068), Vec3(0.03, 0.0, 0.068), Vec3(0.039, 0.0, 0.0), Vec3(0.0, 0.0, -0.007)}) {
    s.to(test::at(place.x(), place.y(), place.z()));
    s.to(test::at(0.0, 0.0, 1.0));
  }
}

TEST_P(Extremes, SupportFaceStaysPutWhenPressed) {
  Rig s(scene);
  s.to(test::at(0.0, 0.0, -0.0101));
  s.to(test::at(0.0, 0.0, -0.007));
  ASSERT_TRUE(s.state.in_contact());
  EXPECT_LT(s.state.regions[0].force.force_n.z(), 0.0);
  for (std::size_t v = 0; v < s.model.rest.vertex_count(); ++v) {
    if (s.model.rest.rest_W_m[2][v] > static_cast<float>(scene.body.support_height_m)) continue;
    for (const auto& column : s.state.field.displacement_m) EXPECT_EQ(column[v], 0.0f);
  }
}

TEST_P(Extremes, BadPosesAreHeld) {
  Rig s(scene);
  s.to(test::at(0.0, 0.0, 0.067));
  const Vec3 force_n = s.state.regions[0].force.force_n;
  for (const double bad :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    for (int k = 0; k < 7; ++k) {
      scene::Pose pose = test::at(0.0, 0.0, 0.067);
      if (k < 3) {
        pose.position_m[k] = bad;
      } else {
        pose.orientation.coeffs()[k - 3] = bad;
      }
      EXPECT_EQ(s.to(pose), StepStatus::not_finite);
      EXPECT_EQ(s.state.regions[0].force.force_n, force_n);
    }
  }
  s.to(test::at(1e300, -1e300, 1e300));
  EXPECT_FALSE(s.state.in_contact());
  Rig fresh(scene);
  EXPECT_EQ(fresh.to(test::at(std::nan(""), 0.0, 0.0)), StepStatus::not_finite);
  EXPECT_EQ(fresh.state.regions[0].force.force_n, Vec3::Zero());
}

TEST_P(Extremes, RandomJumps) {
  Rig s(scene);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(-0.05, 0.05), turn(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    scene::Pose pose = test::at(place(random), place(random), 0.03 + place(random));
    pose.orientation = Eigen::Quaterniond(turn(random), turn(random), turn(random), turn(random));
    s.to(pose);
  }
}

TEST_P(Extremes, CrossSectionOverTwelveDecades) {
  for (double s_c = 1e-9; s_c <= 1e3; s_c *= 10.0) {
    scene.fast.s_c_m2 = s_c;
    Rig s(scene);
    s.to(test::at(0.01, 0.004, 0.071));
    s.to(test::at(0.008, 0.004, 0.065));
    EXPECT_TRUE(s.state.in_contact());
  }
}

TEST_P(Extremes, OneSampleAndAHundredThousand) {
  for (const int samples : {1, 2, 3, 5, 9, 100000}) {
    scene.fast.tool_samples = samples;
    Rig s(scene);
    for (const double z_m : {0.071, 0.068, 0.062, 0.05, 0.03}) s.to(test::at(0.0, 0.001, z_m));
  }
}

TEST_P(Extremes, FewestTriangles) {
  scene.fast.triangles = 12;
  Rig s(scene);
  for (const double z_m : {0.071, 0.068, 0.065}) s.to(test::at(0.004, 0.001, z_m));
}

TEST_P(Extremes, SofteningLawPastItsPeak) {
  scene.contact.k1_n_per_m = 4000.0;
  scene.contact.k3_n_per_m3 = -4000.0 / (3.0 * 0.002 * 0.002);  // peak at 2 mm
  Rig s(scene);
  s.to(test::at(0.0, 0.0, 0.071));
  double before_n = 0.0;
  bool saturated = false;
  for (int i = 0; i <= 60; ++i) {
    const StepStatus status = s.to(test::at(0.0, 0.0, 0.070 - 0.0001 * i));
    saturated = saturated || (status | StepStatus::law_saturated) == status;
    EXPECT_GE(s.state.regions[0].force.magnitude_n, before_n * (1.0 - 0.02));
    before_n = s.state.regions[0].force.magnitude_n;
    EXPECT_LE(before_n, 2.0 / 3.0 * 4000.0 * 0.002 * (1.0 + 1e-12));
  }
  EXPECT_TRUE(saturated);
}

TEST_P(Extremes, PurelyCubicLaw) {
  scene.contact.k1_n_per_m = 0.0;
  Rig s(scene);
  for (const double z_m : {0.071, 0.0699999, 0.069, 0.064}) s.to(test::at(0.0, 0.0, z_m));
  EXPECT_GT(s.state.regions[0].force.magnitude_n, 0.0);
}

TEST_P(Extremes, LocalFactorAtItsLimitAndPastIt) {
  const double limit = 1.0 / std::log((scene.fast.r_R_m + scene.fast.C_r_m) / scene.fast.C_r_m);
  for (const double C_n : {0.0, 0.5 * limit, limit, 10.0 * limit, 1000.0}) {
    scene.fast.C_n = C_n;
    Rig s(scene);
    s.largest_factor = std::max(1.0, C_n / limit);
    for (const double z_m : {0.071, 0.069, 0.064}) s.to(test::at(0.0, 0.0, z_m));
  }
}

TEST_P(Extremes, EveryPoissonsRatio) {
  for (const double nu : {0.0, 0.2, 0.33, 0.4999, 0.5}) {
    scene.body.material.poissons_ratio = nu;
    Rig s(scene);
    for (const double z_m : {0.071, 0.067}) s.to(test::at(0.0, 0.0, z_m));
    EXPECT_GT(s.state.regions[0].force.magnitude_n, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, Extremes,
                         testing::Combine(testing::Values(BodyShape::box, BodyShape::sphere),
                                          testing::Values(Formulation::published, Formulation::corrected)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param) == BodyShape::box ? "Box" : "Sphere") +
                                  (std::get<1>(test.param) == Formulation::published ? "Published" : "Corrected");
                         });

TEST(ExtremeBodies, ThinPlate) {
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    scene::Scene scene = coarse(test::ball_on_cube(formulation));
    scene.body.size_m.z() = 0.0005;
    Rig s(scene);
    for (const double depth_m : {-0.001, 0.0001, 0.0004, 0.003}) s.to(test::at(0.0, 0.0, 0.0105 - depth_m));
    EXPECT_GT(s.state.regions[0].force.force_n.z(), 0.0);
  }
}

TEST(ExtremeBodies, ForceAlongABeam) {
  // Pressed at the corner along the cube's diagonal, straight along one beam.
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    Rig s(coarse(test::ball_on_cube(formulation)));
    const Vec3 corner(0.03, 0.03, 0.06), out = Vec3(1, 1, 1).normalized();
    for (const double gap_m : {0.002, -0.001, -0.004}) s.to({corner + (0.010 + gap_m) * out, test::tilted()});
    ASSERT_TRUE(s.state.in_contact());
    EXPECT_GT(s.state.regions[0].force.force_n.normalized().dot(out), 0.95);
  }
}

}  // namespace
}  // namespace touchstone::fast
