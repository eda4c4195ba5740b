// The extremes: beams without length, in a plane, along the force, of any cross-section and stiffness.
#include "extremes/rig.h"

#include <numeric>

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

/// A force split outside the tick.
struct Split {
  explicit Split(const scene::Scene& scene)
      : model(scene), skeleton(model.skeleton), ends(model.skeleton.anchor_m.size()) {}
  void at(const Vec3& p0_m, const Vec3& force_n, const Vec3& displacement_m) {
    model.formulas.split_force(skeleton, p0_m, force_n, displacement_m, ends);
    for (std::size_t i = 0; i < ends.force_n.size(); ++i) {
      ASSERT_TRUE(ends.force_n[i].allFinite());
      ASSERT_LE(ends.displacement_m[i].norm(), displacement_m.norm() * (1.0 + 1e-9));
    }
  }
  [[nodiscard]] double residual(const Vec3& force_n) const {
    return (support_force_n(ends) + force_n).norm() / force_n.norm();
  }

  FastModel model;
  BeamSkeleton skeleton;
  BeamEnds ends;
};

// A force exactly along one beam: the beams are in equilibrium. As printed: y_i of that beam is 0 / 0; least squares
// leave a residual, here at most the force (E8).
TEST(SkeletonExtremes, ForceAlongABeam) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::cube(formulation));
    rig.may = StepStatus::anchors_limited;
    const Vec3 corner_m(0.03, 0.03, 0.06), out = Vec3(1, 1, 1).normalized();
    for (const double gap_m : {0.002, -0.001, -0.004}) rig.to({corner_m + (0.010 + gap_m) * out, test::tilted()});
    ASSERT_TRUE(rig.state.in_contact());
    EXPECT_GT(rig.force_n().normalized().dot(out), 0.95);
    EXPECT_LE(rig.imbalance(), formulation == Formulation::corrected ? 1e-9 : 1.0);
  }
}

// All anchor points in one plane with the contact, the force perpendicular to it: finite, in equilibrium, all in
// bending. As printed: The axial sum g is 0, so its factor a is 0 / 0 (E8).
TEST(SkeletonExtremes, ForceAcrossAPlaneOfBeams) {
  IN_BOTH_FORMULATIONS(formulation) {
    Split split(extremes::cube(formulation));
    for (Vec3& p_m : split.skeleton.anchor_m) p_m.z() = 0.06;
    const Vec3 force_n(0.0, 0.0, -2.0);
    split.at(Vec3(0.004, 0.001, 0.06), force_n, Vec3(0.0, 0.0, -0.002));
    EXPECT_LE(split.residual(force_n), formulation == Formulation::corrected ? 1e-9 : 1e-6);
    for (std::size_t i = 0; i < split.ends.force_n.size(); ++i)
      EXPECT_LE(std::abs(split.ends.force_n[i].dot(split.ends.beam[i].x)), 1e-9);
  }
}

// The contact on an anchor point itself: no beam shorter than r_R, the split finite and the same on both sides of the
// point. As printed: l_i = 0 and NaN; slightly beside it one beam takes everything (E9).
TEST(SkeletonExtremes, ContactOnAnAnchorHasNoShortBeam) {
  IN_BOTH_FORMULATIONS(formulation) {
    Split split(extremes::cube(formulation));
    const Vec3 anchor_m = split.skeleton.anchor_m[7], force_n(0.3, -0.2, -2.0), D_m(0.0003, -0.0002, -0.002);
    const auto shares_at = [&](const Vec3& off_m) {
      split.at(anchor_m + off_m, force_n, D_m);
      for (const Beam& beam : split.ends.beam) EXPECT_GE(beam.l_m, split.skeleton.r_R_m);
      return split.ends.force_n;
    };
    (void)shares_at(Vec3::Zero());
    for (const double off_m : {1e-15, 1e-12, 1e-8, 1e-6}) {
      const auto before = shares_at(Vec3(-off_m, 0.0, 0.0)), after = shares_at(Vec3(off_m, 0.0, 0.0));
      // The other beams turn by off / l; under E8's least squares a and b follow the turned beam.
      const double apart = formulation == Formulation::corrected ? 1e-3 : 10.0;
      for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LE((before[i] - after[i]).norm(), apart * force_n.norm());
    }
  }
}

// s_c over twelve decades: the force does not depend on it; the thicker the beams, the less the anchor points move,
// never more than the contact. As printed: Thin beams move the body away from its contact (E17).
TEST(SkeletonExtremes, CrossSectionOverTwelveDecades) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (scene::Scene scene : {extremes::cube(formulation), extremes::ball(formulation)}) {
      double before_m = 1e300, force_n = -1.0;
      for (double s_c = 1e-9; s_c <= 1e3; s_c *= 10.0) {
        scene.fast.s_c_m2 = s_c;
        Rig rig(scene);
        rig.may = StepStatus::anchors_limited;
        rig.to(test::at(0.01, 0.004, 0.071));
        rig.to(test::at(0.008, 0.004, 0.065));
        ASSERT_TRUE(rig.state.in_contact());
        EXPECT_LE(rig.largest_end_m(), before_m * (1.0 + 1e-9));
        before_m = rig.largest_end_m();
        if (force_n >= 0.0) {
          EXPECT_EQ(rig.force_n().norm(), force_n);
        }
        force_n = rig.force_n().norm();
      }
      EXPECT_LT(before_m, 1e-9);
    }
  }
}

// E over twelve decades: the force is the law's, whatever E, and so are the fractions that the beams carry. As printed:
// The same: E affects the displacements alone.
TEST(SkeletonExtremes, YoungsModulusOverTwelveDecadesHasNoEffect) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<Vec3> shares;
    for (double E_pa = 10.0; E_pa <= 1e13; E_pa *= 10.0) {
      scene::Scene scene = extremes::cube(formulation);
      scene.body.material.youngs_modulus_pa = E_pa;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(test::pressed(0.002, 0.004, 0.007));
      ASSERT_TRUE(rig.state.in_contact());
      if (shares.empty()) shares = rig.region().ends.force_n;
      for (std::size_t i = 0; i < shares.size(); ++i)
        EXPECT_LE((rig.region().ends.force_n[i] - shares[i]).norm(), 1e-9 * rig.force_n().norm());
    }
  }
}

// r_R larger than the body: every beam has that length, and the split is finite and in equilibrium. As printed: The
// same: l_i = r_R inside R.
TEST(SkeletonExtremes, NeighbourhoodLargerThanTheBody) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::cube(formulation);
    scene.fast.r_R_m = 1.0;
    Rig rig(scene);
    rig.may = StepStatus::anchors_limited;
    rig.to(test::pressed(0.003, 0.004, 0.007));
    for (const Beam& beam : rig.region().ends.beam) EXPECT_EQ(beam.l_m, 1.0);
    EXPECT_LE(rig.imbalance(), formulation == Formulation::corrected ? 1e-9 : 1.0);
  }
}

// r_R of a nanometre: the local factor has no effect. As printed: 1 + C_n ln(...) acts on a range of width zero.
TEST(SkeletonExtremes, NeighbourhoodOfANanometre) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene with = extremes::cube(formulation), without = with;
    with.fast.r_R_m = without.fast.r_R_m = 1e-9;
    without.fast.C_n = 0.0;
    Rig rig(with), plain(without);
    for (Rig* each : {&rig, &plain}) {
      each->may = StepStatus::anchors_limited;
      each->to(test::pressed(0.003, 0.0043, 0.0071));
    }
    for (std::size_t v = 0; v < rig.model.rest.vertex_count(); ++v)
      EXPECT_LE((rig.displacement_m(v) - plain.displacement_m(v)).norm(), 1e-9);
  }
}

// Anchor points moved to one place, onto a line or far apart: cross-sections above 0 that sum to s_c. As printed: The
// fractions are 0 / 0 where the areas vanish.
TEST(SkeletonExtremes, CollapsedAnchorsKeepTheirCrossSections) {
  const FastModel model(extremes::cube(Formulation::corrected));
  CurrentEnds ends(model.skeleton);
  const auto& p_m = model.skeleton.anchor_m;
  std::vector<Vec3> u_m(p_m.size());
  for (const int way : {0, 1, 2, 3}) {
    for (std::size_t i = 0; i < p_m.size(); ++i) {
      if (way == 0) u_m[i] = -p_m[i];
      if (way == 1) u_m[i] = Vec3(0.0, -p_m[i].y(), -p_m[i].z());
      if (way == 2) u_m[i] = i == 0 ? Vec3(1e6, 0, 0) : Vec3(Vec3::Zero());
      if (way == 3) u_m[i] = 1e-300 * p_m[i];
    }
    ends.update(model.skeleton, u_m);
    for (const double s_m2 : ends.area_m2) EXPECT_GT(s_m2, 0.0);
    const double sum_m2 = std::accumulate(ends.area_m2.begin(), ends.area_m2.end(), 0.0);
    EXPECT_NEAR(sum_m2 / model.skeleton.s_c_m2, 1.0, 1e-4) << way;
  }
}

}  // namespace
}  // namespace touchstone::fast
