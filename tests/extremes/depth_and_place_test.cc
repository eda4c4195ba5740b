// The extremes: how deep, and where on the body.
#include "extremes/rig.h"

#include <numbers>

namespace touchstone::fast {
namespace {

using extremes::has;
using extremes::Rig;
using scene::Vec3;

/// Largest force counted as none: the smallest cells of a curved tool bulge out of it [N].
constexpr double touch_n = 1e-7;

// A tool that only touches: no force, and the force goes to zero with the depth. As printed: The force is distributed
// by lever arms whose sum may be 0, so first touch is 0 / 0 (E6).
TEST(DepthAndPlace, FirstTouchHasNoForce) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      Rig rig(scene);
      const double top_m = rig.model.body->bounds().upper_m.z() + scene.tool.radius_m;
      rig.to(test::at(0.0, 0.0, top_m + 0.001));
      rig.to(test::at(0.0, 0.0, top_m));
      EXPECT_LT(rig.force_n().norm(), touch_n);
      double before_n = 1e300;
      for (double depth_m = 1e-3; depth_m > 1e-18; depth_m /= 10.0) {
        rig.to(test::at(0.0, 0.0, top_m - depth_m));
        EXPECT_LE(rig.force_n().norm(), before_n + touch_n);
        before_n = rig.force_n().norm();
      }
      EXPECT_LT(before_n, touch_n);
    }
  }
}

// All samples of a punch flush with the face: no force, and 1e-15 m deeper the law's force. As printed: Contact is
// where two meshes intersect, and flush triangles intersect nowhere or everywhere.
TEST(DepthAndPlace, FlushPunchHasNoForce) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::punch_on_cube(formulation));
    rig.to(extremes::punched(-1e-15));
    EXPECT_EQ(rig.force_n(), Vec3::Zero());
    rig.to(extremes::punched(1e-15));
    ASSERT_TRUE(rig.state.in_contact());
    EXPECT_NEAR(rig.force_n().z() / (40.0 * 1e-15), 1.0, 0.05);  // numbers are 1.4e-17 m apart here
    rig.to(extremes::punched(1e-9));
    EXPECT_NEAR(rig.force_n().z() / (40.0 * 1e-9), 1.0, 1e-6);
  }
}

// Pressed as deep as the body is thick: the force rises up to the depth limit and stays constant, and the status
// reports it. As printed: Nothing bounds the depth: the cubic term continues.
TEST(DepthAndPlace, DepthOfTheWholeBodyIsLimited) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::punch_on_cube(formulation));
    rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
    StepStatus status = StepStatus::ok;
    double before_n = 0.0;
    for (int i = 0; i < 58; ++i) {
      status = rig.to(extremes::punched(0.001 * i));
      EXPECT_GE(rig.force_n().z(), before_n * (1.0 - 1e-12));
      before_n = rig.force_n().z();
    }
    EXPECT_TRUE(has(status, StepStatus::depth_limited));
    EXPECT_NEAR(before_n, rig.law().force_n(depth_limit_rel * 0.06), 1e-9 * before_n);
  }
}

// Moved through the body and out at the far side: the force never reverses, and in the end there is no force, no region
// and a surface at rest. As printed: The direction is not specified; the closest side changes half way, and would push
// the tool out there.
TEST(DepthAndPlace, ThroughTheBodyAndOutLeavesNothing) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      Rig rig(scene);
      rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
      for (int i = 0; i <= 100; ++i) {
        rig.to(test::at(0.003, 0.0, 0.08 - 0.001 * i));
        // Never reversed, as long as there is a force.
        EXPECT_GE(rig.force_n().z(), 0.0) << i;
      }
      EXPECT_FALSE(rig.state.in_contact());
      EXPECT_EQ(rig.force_n(), Vec3::Zero());
      EXPECT_EQ(rig.largest_displacement_m(), 0.0);
    }
  }
}

// The body entirely inside the tool: no force, and none remains from the motion there. As printed: The same: surfaces
// that do not intersect are not in contact.
TEST(DepthAndPlace, BodyWhollyInsideTheToolIsNoContact) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::punch_on_cube(formulation);
    scene.tool.size_m = Vec3(0.2, 0.2, 0.2);
    Rig rig(scene);
    rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
    for (int i = 0; i <= 75; ++i) rig.to(test::at(0.0, 0.0, 0.162 - 0.002 * i));
    EXPECT_FALSE(rig.state.in_contact());
    EXPECT_EQ(rig.force_n(), Vec3::Zero());
    EXPECT_EQ(rig.largest_displacement_m(), 0.0);
  }
}

// In the middle of the body from the first tick on: a force within the limit, which a step of 1e-12 m changes by at
// most slope times step. As printed: Without an earlier contact there is no direction of deformation.
TEST(DepthAndPlace, ToolWhollyInsideTheBodyIsContinuous) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      Rig rig(scene);
      rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
      rig.to(test::at(0.0, 0.0, 0.03));
      ASSERT_TRUE(rig.state.in_contact());
      const Vec3 force_n = rig.force_n();
      EXPECT_GT(force_n.norm(), 0.0);
      rig.to(test::at(1e-12, 0.0, 0.03));
      const double slope = rig.law().slope_n_per_m(rig.region().extent.deepest_m);
      EXPECT_LE((rig.force_n() - force_n).norm(), 4.0 * slope * 1e-12 + 1e-9 * force_n.norm());
    }
  }
}

// A tool larger than the body, lowered over it: the force stays within the law's bound. As printed: The same, as far as
// its vertices touch the body.
TEST(DepthAndPlace, ToolLargerThanTheBodyIsBounded) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (scene::Scene scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      scene.tool.radius_m = 0.048;
      Rig rig(scene);
      rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
      double most_n = 0.0;
      for (int i = 0; i <= 60; ++i) {
        rig.to(test::at(0.0, 0.0, 0.12 - 0.002 * i));
        most_n = std::max(most_n, rig.force_n().norm());
      }
      EXPECT_GT(most_n, 1.0);
    }
  }
}

// 50 mm in one tick: the force points back to where the tool came from, along the direction of a slow press. As
// printed: The direction is not specified; at that depth the closest side is any of six.
TEST(DepthAndPlace, JumpOfFiftyMillimetresKeepsItsDirection) {
  IN_BOTH_FORMULATIONS(formulation) {
    const Vec3 middle_m(0.0, 0.0, 0.03);
    for (const Vec3& from : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
      Rig rig(extremes::cube(formulation));
      rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
      rig.to({middle_m + 0.041 * from, Eigen::Quaterniond::Identity()});
      EXPECT_FALSE(rig.state.in_contact());
      rig.to({middle_m - 0.009 * from, Eigen::Quaterniond::Identity()});
      ASSERT_TRUE(rig.state.in_contact());
      EXPECT_GT(rig.force_n().normalized().dot(from), 0.999) << from.transpose();
    }
  }
}

// 51 mm along the face in one tick: without friction the same as a new press there. As printed: The same, once a new
// submesh has been separated.
TEST(DepthAndPlace, TangentialJumpIsANewPress) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig jumped(extremes::cube(formulation)), fresh(extremes::cube(formulation));
    jumped.to(test::pressed(0.002, -0.018, -0.018));
    jumped.to(test::pressed(0.002, 0.018, 0.018));
    fresh.to(test::pressed(-0.001, 0.018, 0.018));
    fresh.to(test::pressed(0.002, 0.018, 0.018));
    ASSERT_TRUE(fresh.state.in_contact());
    EXPECT_LE((jumped.force_n() - fresh.force_n()).norm(), 1e-12 * fresh.force_n().norm());
    EXPECT_NEAR(jumped.largest_displacement_m(), fresh.largest_displacement_m(), 1e-7);
  }
}

// From far away towards the centre over corners, edges, faces and the support, in steps and at once: finite and within
// the law's bound. As printed: The beam to a corner, which is an anchor point, has length 0 and is NaN (E9).
TEST(DepthAndPlace, EveryCornerEdgeAndFaceIsBounded) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      const bool box = scene.body.shape == scene::BodyShape::box;
      Rig rig(scene);
      rig.may = StepStatus::depth_limited | StepStatus::anchors_limited;
      for (const Vec3& out : {Vec3(1, 1, 1), Vec3(1, -1, 1), Vec3(1, 0, 1), Vec3(1, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0),
                              Vec3(0, 0, -1), Vec3(1, 0, -1), Vec3(1, 1, -1), Vec3(1e-9, 0, 1)}) {
        for (int i = 0; i <= 40; ++i)
          rig.to({Vec3(0.0, 0.0, 0.03) + (0.065 - 0.001 * i) * (box ? out : out.normalized()), test::tilted()});
        EXPECT_TRUE(rig.state.in_contact());
        rig.to(test::at(0.0, 0.0, 1.0));
        rig.to({Vec3(0.0, 0.0, 0.03) + 0.038 * out.normalized(), test::tilted()});
        rig.to(test::at(0.0, 0.0, 1.0));
      }
    }
  }
}

// On a corner, along the diagonal: the force points back along it and is equal on all four upper corners. As printed:
// NaN, as above (E9).
TEST(DepthAndPlace, CornersHaveEqualForces) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<double> size_n;
    for (const Vec3& out : {Vec3(1, 1, 1), Vec3(-1, 1, 1), Vec3(1, -1, 1), Vec3(-1, -1, 1)}) {
      scene::Scene scene = extremes::cube(formulation);
      scene.fast.tool_samples = 20000;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      const Vec3 corner_m = Vec3(0.0, 0.0, 0.03) + 0.03 * out;
      for (const double depth_m : {-0.001, 0.001, 0.003})
        rig.to({corner_m + (0.010 - depth_m) * out.normalized(), Eigen::Quaterniond::Identity()});
      ASSERT_TRUE(rig.state.in_contact());
      EXPECT_GT(rig.force_n().normalized().dot(out.normalized()), 0.999);
      size_n.push_back(rig.force_n().norm());
    }
    const auto [least, most] = std::minmax_element(size_n.begin(), size_n.end());
    EXPECT_LE(*most, 1.03 * *least);
  }
}

// Exactly over an anchor point, an edge, the bottom rim and the middle of the support: a force within the law's bound,
// and a surface at rest after release. As printed: Over an anchor point l_i = 0 and the force split is NaN (E9).
TEST(DepthAndPlace, ExactlyOverAnAnchorAnEdgeAndTheRim) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::cube(formulation));
    rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
    const Vec3 middle_m(0.0, 0.0, 0.03);
    for (const Vec3& place_m :
         {Vec3(0.03, 0.03, 0.068), Vec3(0.03, 0.0, 0.068), Vec3(0.039, 0.0, 0.0), Vec3(0.0, 0.0, -0.007)}) {
      const scene::Pose apart{middle_m + 2.0 * (place_m - middle_m), Eigen::Quaterniond::Identity()};
      rig.to(apart);
      rig.to({place_m, Eigen::Quaterniond::Identity()});
      EXPECT_GT(rig.force_n().norm(), 0.0) << place_m.transpose();
      rig.to(apart);
      EXPECT_EQ(rig.force_n(), Vec3::Zero());
      EXPECT_EQ(rig.largest_displacement_m(), 0.0);
    }
  }
}

// Pressed on the support from below: a contact force without displacement. As printed: Anchor points of the bottom move
// like any other; the support is not specified.
TEST(DepthAndPlace, SupportFaceDoesNotMove) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(test::at(0.0, 0.0, -0.0101));
      rig.to(test::at(0.0, 0.0, -0.007));
      ASSERT_TRUE(rig.state.in_contact());
      EXPECT_LT(rig.force_n().z(), 0.0);
      for (std::size_t v = 0; v < rig.model.rest.vertex_count(); ++v) {
        if (rig.model.rest.rest_W_m[2][v] > static_cast<float>(scene.body.support_height_m)) continue;
        EXPECT_TRUE(rig.displacement_m(v).isZero(0.0));
      }
    }
  }
}

// A ball moved around every free edge of the box at constant depth: the force changes by at most 4 times slope times
// step per tick. As printed: The direction is not specified; the normal of a mesh jumps at an edge by up to a right
// angle.
TEST(DepthAndPlace, ForceIsContinuousOverEveryEdgeOfABox) {
  IN_BOTH_FORMULATIONS(formulation) {
    struct Edge {
      Vec3 middle_m, first, second;  // outward normals of its faces
    };
    std::vector<Edge> edges;
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
      edges.push_back({Vec3(0, 0, 0.06) + 0.03 * side, Vec3::UnitZ(), side});
    for (const double x : {1.0, -1.0})
      for (const double y : {1.0, -1.0})
        edges.push_back({Vec3(0.03 * x, 0.03 * y, 0.03), x * Vec3::UnitX(), y * Vec3::UnitY()});
    for (const Edge& edge : edges) {
      scene::Scene scene = extremes::cube(formulation);
      scene.fast.tool_samples = 8000;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      constexpr double out_m = 0.010 - 0.002;
      // Along the first face, a quarter turn about the edge, then along the second face.
      const auto pose_at = [&](int i) {
        constexpr int flat = 25, turn = 60;
        Vec3 p_m;
        if (i < flat) {
          p_m = edge.middle_m + out_m * edge.first - 4e-4 * (flat - i) * edge.second;
        } else if (i < flat + turn) {
          const double angle = 0.5 * std::numbers::pi * (i - flat) / turn;
          p_m = edge.middle_m + out_m * (std::cos(angle) * edge.first + std::sin(angle) * edge.second);
        } else {
          p_m = edge.middle_m + out_m * edge.second - 4e-4 * (i - flat - turn) * edge.first;
        }
        return scene::Pose{p_m, Eigen::Quaterniond::Identity()};
      };
      EXPECT_LE(extremes::steepest(rig, 110, pose_at), 4.0) << edge.middle_m.transpose();
      EXPECT_GT(rig.force_n().normalized().dot(edge.second), 0.999);
    }
  }
}

// Moved over the anchor points of an ellipsoid: the force changes by at most 4 times slope times step per tick. As
// printed: NaN at the anchor point itself (E9); x_i reverses there.
TEST(DepthAndPlace, ForceIsContinuousOverAnEllipsoidsAnchor) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::ellipsoid(formulation, Vec3(0.05, 0.03, 0.02), 0.004);
    scene.fast.tool_samples = 8000;
    Rig top(scene);
    top.may = StepStatus::anchors_limited;
    const auto over_the_pole = [](int i) {
      const double angle = 0.005 * (i - 40);
      const Vec3 p_m(0.05 * std::sin(angle), 0.0, 0.02 + 0.02 * std::cos(angle));
      const Vec3 normal = Vec3(std::sin(angle) / 0.05, 0.0, std::cos(angle) / 0.02).normalized();
      return scene::Pose{p_m + 0.008 * normal, Eigen::Quaterniond::Identity()};
    };
    EXPECT_LE(extremes::steepest(top, 80, over_the_pole), 4.0);
    Rig side(scene);
    side.may = StepStatus::anchors_limited;
    const auto around_the_end = [](int i) {
      const double angle = 0.010 * (i - 40);
      const Vec3 p_m(0.05 * std::cos(angle), 0.03 * std::sin(angle), 0.02);
      const Vec3 normal = Vec3(std::cos(angle) / 0.05, std::sin(angle) / 0.03, 0.0).normalized();
      return scene::Pose{p_m + 0.008 * normal, Eigen::Quaterniond::Identity()};
    };
    EXPECT_LE(extremes::steepest(side, 80, around_the_end), 4.0);
  }
}

}  // namespace
}  // namespace touchstone::fast
