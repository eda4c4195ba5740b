// The extremes: bodies that are needles, plates, pointed, tiny or very large.
#include "extremes/rig.h"

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

scene::Scene revolution(Formulation formulation, const scene::Profile& profile) {
  scene::Scene scene = extremes::cube(formulation);
  scene.body.shape = scene::BodyShape::revolution;
  scene.body.profile = profile;
  return scene;
}

/// The first sample is at most this far behind the ball's surface, in any direction.
constexpr double touch_m = 0.0005;

/// Moved towards the body's centre from the given side, to this depth beyond first touch, and back.
double press_from(Rig& rig, const Vec3& side, double depth_m, const Vec3& aside_m = Vec3::Zero()) {
  const scene::Bounds bounds = rig.model.body->bounds();
  const Vec3 middle_m = 0.5 * (bounds.lower_m + bounds.upper_m) + aside_m;
  const double far_m = (bounds.upper_m - bounds.lower_m).norm() + 0.05;
  // First touch of a ball of 10 mm along this line.
  double low_m = 0.0, high_m = far_m;
  for (int i = 0; i < 60; ++i) {
    const double at_m = 0.5 * (low_m + high_m);
    (rig.model.body->signed_distance_m(middle_m + at_m * side) > 0.010 ? high_m : low_m) = at_m;
  }
  double most_n = 0.0;
  for (int i = -4; i <= 20; ++i) {
    rig.to({middle_m + (high_m - (depth_m + touch_m) * i / 20.0) * side, Eigen::Quaterniond::Identity()});
    most_n = std::max(most_n, rig.force_n().norm());
  }
  rig.to({middle_m + far_m * side, Eigen::Quaterniond::Identity()});
  EXPECT_EQ(rig.force_n(), Vec3::Zero());
  return most_n;
}

// An ellipsoid 40 times as long as wide: pressed from every side, on its tips and its flanks, within the law's bound.
// As printed: The same away from the tips, which are anchor points (E9).
TEST(ShapeExtremes, NeedleEllipsoid) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::ellipsoid(formulation, Vec3(0.2, 0.005, 0.005), 0.001));
    rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(0, 0.6, 0.8)}) {
      EXPECT_GT(press_from(rig, side, 0.002), 0.05) << side.transpose();
      EXPECT_GT(press_from(rig, side, 0.002, Vec3(0.05, 0.0, 0.0)), 0.0);
    }
  }
}

// An ellipsoid 40 times as wide as high: pressed from every side, on its rim and its flat sides, within the law's
// bound. As printed: The same away from the anchor points (E9).
TEST(ShapeExtremes, PancakeEllipsoid) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::ellipsoid(formulation, Vec3(0.1, 0.1, 0.0025), 0.0005));
    rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
    for (const Vec3& side :
         {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0.6, 0, 0.8), Vec3(0.999, 0, 0.04).normalized()}) {
      EXPECT_GT(press_from(rig, side, 0.002), 0.01) << side.transpose();
      EXPECT_GT(press_from(rig, side, 0.002, Vec3(0.03, 0.02, 0.0)), 0.0);
    }
  }
}

// A plate of 0.5 mm on 200 mm: pressed through and released; the depth is limited to a quarter of a millimetre, and the
// status reports it. As printed: Nothing bounds the depth.
TEST(ShapeExtremes, PlateOfHalfAMillimetre) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::punch_on_cube(formulation);
    scene.body.size_m = Vec3(0.2, 0.2, 0.0005);
    Rig rig(scene);
    rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
    const auto to = [&](double depth_m) { return rig.to(test::at(0.01, 0.0, 0.0105 - depth_m)); };
    double before_n = 0.0;
    for (int i = -5; i <= 48; ++i) {
      const StepStatus status = to(1e-5 * i);
      EXPECT_GE(rig.force_n().z(), before_n * (1.0 - 1e-12));
      EXPECT_EQ(extremes::has(status, StepStatus::depth_limited), i > 25);
      before_n = rig.force_n().z();
    }
    EXPECT_NEAR(before_n / rig.law().force_n(0.00025), 1.0, 1e-9);
    to(-0.001);
    EXPECT_EQ(rig.largest_displacement_m(), 0.0);
  }
}

// A cone of 11 degrees, pressed on its apex, slowly and in one tick: the force is along the axis; from every side it is
// within the law's bound. As printed: The apex is an anchor point, and the beam to it has length 0 (E9).
TEST(ShapeExtremes, SharpApex) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Profile cone;
    cone.rz_m = {{0.0, 0.0}, {0.01, 0.0}, {0.0, 0.1}};
    scene::Scene scene = revolution(formulation, cone);
    scene.fast.tool_samples = 50000;  // closer than the cone's thickness at this depth
    Rig rig(scene);
    rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
    for (const int ticks : {1, 60}) {
      for (int i = 0; i <= ticks; ++i) rig.to(test::at(0.0, 0.0, 0.111 - 0.005 * i / ticks));
      ASSERT_TRUE(rig.state.in_contact());
      EXPECT_GT(rig.force_n().normalized().z(), 0.999) << ticks;
      rig.to(test::at(0.0, 0.0, 1.0));
    }
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, 0.0, 0.8), Vec3(0, 0, 1)})
      EXPECT_GT(press_from(rig, side, 0.002), 0.01) << side.transpose();
  }
}

// A wire of 0.4 mm on 100 mm, and a coin of 0.2 mm on 60 mm: within the law's bound from every side, and nothing left;
// end on, a wire thinner than the distance between samples is missed. As printed: The same with the vertices of the
// tool's mesh.
TEST(ShapeExtremes, WireAndCoin) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const auto& [r_m, h_m] : {std::pair(0.0002, 0.1), std::pair(0.03, 0.0002)}) {
      scene::Profile profile;
      profile.rz_m = {{0.0, 0.0}, {r_m, 0.0}, {r_m, h_m}, {0.0, h_m}};
      Rig rig(revolution(formulation, profile));
      rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
      for (const Vec3& side : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)}) {
        const double most_n = press_from(rig, side, 0.0);
        if (side.z() == 1.0 && r_m > h_m) {
          EXPECT_GT(most_n, 0.0);
        }
      }
    }
  }
}

/// All lengths times s. Of the law, k1 is scaled by s and k3 by 1 / s, so that forces are proportional to s^2, as are
/// those of the beams.
scene::Scene scaled(scene::Scene scene, double s) {
  scene.body.size_m *= s;
  scene.body.radius_m *= s;
  scene.body.semi_axes_m *= s;
  scene.body.support_height_m *= s;
  scene.tool.radius_m *= s;
  scene.contact.k1_n_per_m *= s;
  scene.contact.k3_n_per_m3 /= s;
  scene.contact.r_th_m *= s;
  scene.fast.r_R_m *= s;
  scene.fast.C_r_m *= s;
  scene.fast.s_c_m2 *= s * s;
  for (scene::Waypoint& waypoint : scene.track) waypoint.pose.position_m *= s;
  return scene;
}

// Bodies of 0.1 mm and of 8 m: forces are proportional to the square of the length, displacements to the length. As
// printed: The same: the method has no fixed length.
TEST(ShapeExtremes, TinyAndHugeBodies) {
  IN_BOTH_FORMULATIONS(formulation) {
    const std::vector<scene::Scene> scenes{extremes::cube(formulation), extremes::ball(formulation),
                                           extremes::ellipsoid(formulation, Vec3(0.05, 0.03, 0.02), 0.004)};
    for (scene::Scene scene : scenes) {
      scene.contact.friction = scene::Friction{0.5, 1.0, 0.4};
      Rig plain(scene);
      plain.may = StepStatus::anchors_limited;
      const double top_m = plain.model.body->bounds().upper_m.z() + 0.010;
      for (const double s : {1.0 / 512.0, 128.0}) {
        Rig other(scaled(scene, s));
        other.may = StepStatus::anchors_limited;
        plain.to(test::at(0.004, 0.0, top_m + 0.001));
        other.to(test::at(0.004 * s, 0.0, (top_m + 0.001) * s));
        for (int i = 0; i <= 20; ++i) {
          const Vec3 p_m(0.004 + 0.0002 * i, 0.0001 * i, top_m - 0.0003 * std::min(i, 10));
          plain.to({p_m, Eigen::Quaterniond::Identity()});
          other.to({p_m * s, Eigen::Quaterniond::Identity()});
          ASSERT_LE((other.force_n() / (s * s) - plain.force_n()).norm(), 1e-9 * plain.force_n().norm() + 1e-12) << i;
        }
        EXPECT_GT(plain.force_n().norm(), 0.1);
        for (std::size_t v = 0; v < plain.model.rest.vertex_count(); ++v)
          EXPECT_LE((other.displacement_m(v) / s - plain.displacement_m(v)).norm(),
                    1e-5 * plain.largest_displacement_m());
        plain.to(test::at(0.0, 0.0, 1.0));
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
