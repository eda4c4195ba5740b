// The extremes: the response model.
#include "extremes/rig.h"

#include "fast/response/response_engine.h"
#include "support/synthetic_response.h"

#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// @param compliance  of the body, in the order of the contact's own; 0 for a half space
ResponseEngine engine_of(const scene::Scene& scene, double compliance = 1.0) {
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const double C_m_per_n = 60.0 * compliance / scene.body.material.youngs_modulus_pa;
  return {scene, surface, test::synthetic_response(scene, surface, C_m_per_n)};
}

scene::Scene press() {
  scene::Scene scene = test::ball_on_cube();
  scene.fast.triangles = 600;
  return scene;
}

void expect_sound(const ResponseEngine& engine) {
  EXPECT_TRUE(engine.wrench().force_n.allFinite() && engine.wrench().torque_nm.allFinite());
  EXPECT_TRUE(matrix_of(engine.field().displacement_m).allFinite());
  EXPECT_LT((matrix_of(engine.field().normal).colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-4);
  const ResponseContact& contact = engine.contacts()[0];
  EXPECT_GE((engine.wrench().force_n - contact.friction_n).dot(contact.at.normal), 0.0);
}

// Depths from a picometre to three times the ball's radius: force and shape are finite, the force rises with the depth,
// and the status reports a depth beyond the tip. As printed: There is no such model.
TEST(ResponseExtremes, DepthOverElevenDecades) {
  ResponseEngine engine = engine_of(press());
  double last_n = 0.0;
  for (double depth_m = 1e-12; depth_m < 0.03; depth_m *= 1.5) {
    const StepStatus status = engine.step(test::pressed(depth_m, 0.001, -0.002));
    expect_sound(engine);
    EXPECT_GE(engine.wrench().force_n.z(), last_n) << depth_m;
    EXPECT_EQ(extremes::has(status, StepStatus::tip_exceeded), depth_m > 0.010) << depth_m;
    last_n = engine.wrench().force_n.z();
  }
}

// Young's modulus from 1 Pa to 1e13 Pa with a compliance that follows it: the force is proportional to it, to 1e-9, and
// the shape is the same. As printed: There is no such model.
TEST(ResponseExtremes, ModulusOverThirteenDecades) {
  scene::Scene scene = press();
  double force_per_pa = 0.0, largest_m = 0.0;
  for (double modulus_pa = 1.0; modulus_pa < 2e13; modulus_pa *= 1e3) {
    scene.body.material.youngs_modulus_pa = modulus_pa;
    ResponseEngine engine = engine_of(scene);
    EXPECT_EQ(engine.step(test::pressed(0.004)), StepStatus::ok);
    expect_sound(engine);
    const double now_per_pa = engine.wrench().force_n.z() / modulus_pa;
    const double now_m = matrix_of(engine.field().displacement_m).cwiseAbs().maxCoeff();
    if (force_per_pa > 0.0) {
      EXPECT_NEAR(now_per_pa, force_per_pa, 1e-9 * force_per_pa);
      EXPECT_NEAR(now_m, largest_m, 1e-4 * largest_m);
    }
    force_per_pa = now_per_pa;
    largest_m = now_m;
  }
}

// Poisson's ratio from 0 to 0.5: finite, and the force changes by less than a tenth from one value to the next. As
// printed: There is no such model.
TEST(ResponseExtremes, PoissonsRatioFromZeroToAHalf) {
  scene::Scene scene = press();
  double last_n = 0.0;
  for (double nu = 0.0; nu <= 0.5001; nu += 0.05) {
    scene.body.material.poissons_ratio = std::min(nu, 0.5);
    ResponseEngine engine = engine_of(scene);
    engine.step(test::pressed(0.004));
    expect_sound(engine);
    if (last_n > 0.0) {
      EXPECT_NEAR(engine.wrench().force_n.z() / last_n, 1.0, 0.1) << nu;
    }
    last_n = engine.wrench().force_n.z();
  }
}

// A ball from 1/1000 of the body's size up to the body's size on a half space: as the depth goes to nothing the force
// is Hertz's. As printed: There is no such model.
TEST(ResponseExtremes, BallsOverThreeDecadesAreHertzsInTheLimit) {
  for (double radius_m = 6e-5; radius_m <= 0.06; radius_m *= 10.0) {
    scene::Scene scene = press();
    scene.tool.radius_m = radius_m;
    const double depth_m = 1e-4 * radius_m;
    const auto at = [&](double down_m) { return test::at(0.0, 0.0, 0.060 + radius_m - down_m); };
    scene.track = {{0.0, at(-depth_m)}, {1.0, at(depth_m)}};
    ASSERT_EQ(scene::response_needs(scene), "") << radius_m;
    ResponseEngine engine = engine_of(scene, 0.0);
    EXPECT_EQ(engine.step(at(depth_m)), StepStatus::ok);
    expect_sound(engine);
    const double hertz_n =
        4.0 / 3.0 * scene.body.material.contact_modulus_pa() * std::sqrt(radius_m) * std::pow(depth_m, 1.5);
    EXPECT_NEAR(engine.wrench().force_n.z() / hertz_n, 1.0, 0.01) << radius_m;
  }
}

// A ball that enters in one tick, leaves and comes back in another order of poses: the force depends on the pose alone,
// bit for bit. As printed: There is no such model.
TEST(ResponseExtremes, NoHistory) {
  ResponseEngine slow = engine_of(press()), jumping = engine_of(press());
  for (int i = 0; i <= 100; ++i) slow.step(test::pressed(5e-5 * i));
  for (const double depth_m : {0.02, -0.5, 0.005}) jumping.step(test::pressed(depth_m));
  EXPECT_EQ(slow.wrench().force_n, jumping.wrench().force_n);
  EXPECT_EQ(slow.field().displacement_m, jumping.field().displacement_m);
  EXPECT_EQ(slow.field().normal, jumping.field().normal);
}

// Coefficients of friction from 0 to 1e6 under a tool that jumps over a cube and a ball: force and shape are finite,
// and the friction is at most its limit. As printed: There is no such model.
TEST(ResponseExtremes, FrictionOverAllCoefficients) {
  for (const bool round : {false, true}) {
    scene::Scene scene = round ? test::ball_on_sphere() : press();
    scene.fast.triangles = 600;
    for (const double mu : {0.0, 1e-9, 0.3, 10.0, 1e6}) {
      scene.contact.friction = scene::Friction{.K = mu, .beta = 1.0, .mu_D = mu};
      ResponseEngine engine = engine_of(scene);
      double largest_n = 0.0;
      for (int i = 0; i < 300; ++i) {
        const double depth_m = 0.012 * std::abs(std::sin(0.7 * i)), slope = 0.3 * std::sin(i * i);
        scene::Pose pose = test::pressed(depth_m, 0.03 * slope, 0.001 * i * std::sin(0.1 * i));
        if (round)
          pose.position_m = Vec3(0.0, 0.0, 0.03) + (0.04 - depth_m) * Vec3(slope, 0.2 * slope, 1.0).normalized();
        pose.orientation = Eigen::AngleAxisd(0.3 * i, Vec3::UnitX());
        engine.step(pose);
        expect_sound(engine);
        if (!engine.in_contact()) continue;
        const scene::RegionRecord region = engine.record(0.0, pose, depth_m).regions.front();
        const double normal_n = engine.contacts()[0].load.force_n;
        EXPECT_LE(region.friction_n.norm(), mu * normal_n * (1.0 + 1e-9)) << mu << ' ' << i;
        largest_n = std::max(largest_n, region.friction_n.norm());
      }
      EXPECT_EQ(largest_n > 0.0, mu > 0.0);
    }
  }
}

// A capsule on its side, its length from 1e-4 to 6 of its radius, turned about two axes: force and shape are finite,
// and the status reports when it does not lie flat. As printed: There is no such model.
TEST(ResponseExtremes, ACapsuleOnItsSideTurnedAnyWay) {
  scene::Scene scene = press();
  scene.tool.shape = scene::ToolShape::capsule;
  scene.tool.radius_m = 0.006;
  for (const double length : {1e-4, 1e-2, 1.0, 6.0}) {
    scene.tool.length_m = length * scene.tool.radius_m;
    const auto turned = [&](double about_x, double about_z) {
      scene::Pose pose = test::at(0.0, 0.0, 0.064);
      pose.orientation = Eigen::AngleAxisd(about_z, Vec3::UnitZ()) *
                         Eigen::AngleAxisd(0.5 * std::numbers::pi + about_x, Vec3::UnitX());
      return pose;
    };
    scene.track = {{0.0, turned(0.0, 0.0)}, {1.0, turned(0.0, 0.0)}};
    ASSERT_EQ(scene::response_needs(scene), "") << length;
    ResponseEngine engine = engine_of(scene);
    for (int i = 0; i <= 40; ++i) {
      const double about_x = 0.05 * std::numbers::pi * i;
      const StepStatus status = engine.step(turned(about_x, 0.7 * i));
      expect_sound(engine);
      EXPECT_GT(engine.wrench().force_n.z(), 0.0);
      EXPECT_EQ(extremes::has(status, StepStatus::tilted), i % 20 != 0) << i;
      const scene::InstantRecord record = engine.record(0.0, turned(about_x, 0.7 * i), 0.002);
      EXPECT_TRUE(record.traction_pa.allFinite());
      EXPECT_TRUE(std::isfinite(record.pressure_peak_pa) && std::isfinite(record.regions.front().area_m2));
    }
  }
}

// A tool that leaves the grid of the response, and the body: the force stays bounded, and the status reports it. As
// printed: There is no such model.
TEST(ResponseExtremes, BeyondTheGrid) {
  ResponseEngine engine = engine_of(press());
  engine.step(test::pressed(0.002));
  const double middle_n = engine.wrench().force_n.z();
  for (int i = 0; i < 400; ++i) {
    const StepStatus status = engine.step(test::pressed(0.002, 1e-4 * i));
    expect_sound(engine);
    EXPECT_LT(engine.wrench().force_n.norm(), 2.0 * middle_n) << i;
    if (i > 100 && engine.in_contact()) {
      EXPECT_TRUE(extremes::has(status, StepStatus::outside_grid)) << i;
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
