// The extremes: ever finer samples, triangles, ticks and instants.
#include "extremes/rig.h"
#include "fast/run/run.h"

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

/// Each value is closer to the last than the value before, or within `close` times the last.
void expect_converging(const std::vector<double>& values, double close) {
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double before = std::abs(values[i - 1] - values.back()), now = std::abs(values[i] - values.back());
    EXPECT_LE(now, std::max(0.8 * before, close * std::abs(values.back()))) << i << ": " << values[i];
  }
}

// Samples from 500 to 128,000, by factors of four: the force converges. As printed: The vertices of a mesh, if evenly
// distributed; the force converges, but its limit depends on their distribution.
TEST(ConvergenceExtremes, ForceInTheSamples) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<double> force_n;
    for (const int samples : {500, 2000, 8000, 32000, 128000}) {
      scene::Scene scene = extremes::cube(formulation);
      scene.fast.tool_samples = samples;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(test::pressed(0.004, 0.003, -0.005));
      force_n.push_back(rig.force_n().norm());
    }
    expect_converging(force_n, 0.01);
    EXPECT_NEAR(force_n[3] / force_n[4], 1.0, 0.03);
  }
}

// Triangles from 300 to 19,200: the force does not depend on them, and the corrected mean displacement converges. As
// printed: The force does not depend on them, either; the anchor points are vertices of the mesh.
TEST(ConvergenceExtremes, ShapeInTheTriangles) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<double> mean_m, force_n;
    for (const int triangles : {300, 1200, 4800, 19200}) {
      scene::Scene scene = extremes::cube(formulation);
      scene.fast.triangles = triangles;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(test::pressed(0.004, 0.003, -0.005));
      const std::vector<double>& area_m2 = rig.model.surface.vertex_area_m2;
      double sum = 0.0, area = 0.0;
      for (std::size_t v = 0; v < area_m2.size(); ++v) {
        sum += area_m2[v] * rig.displacement_m(v).squaredNorm();
        area += area_m2[v];
      }
      mean_m.push_back(std::sqrt(sum / area));
      force_n.push_back(rig.force_n().norm());
    }
    for (const double one_n : force_n) EXPECT_DOUBLE_EQ(one_n, force_n.front());
    expect_converging(mean_m, 0.02);
  }
}

// Ticks from 20 Hz to 10 kHz: in a straight press without friction the force depends on the depth alone, to 1e-6. As
// printed: The same: ticks depend on each other only through the regions.
TEST(ConvergenceExtremes, PressInTheTicks) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<double> force_n;
    for (const int ticks : {1, 20, 1000, 10000}) {
      Rig rig(extremes::cube(formulation));
      rig.may = StepStatus::anchors_limited;
      for (int i = 0; i <= ticks; ++i) {
        const double depth_m = ticks == 1 ? 0.004 : -0.001 + 0.005 * i / ticks;
        rig.to(test::pressed(depth_m, 0.003, -0.005));
      }
      force_n.push_back(rig.force_n().norm());
    }
    for (const double one_n : force_n) EXPECT_NEAR(one_n / force_n.back(), 1.0, 1e-6);
  }
}

// A sticking drag with friction in shorter and shorter ticks: the friction at its end converges. As printed: The same;
// at the onset of slip the force jumps, in whatever tick that is (E5).
TEST(ConvergenceExtremes, DragInTheTicks) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<double> friction_n;
    for (const int ticks : {25, 100, 400, 1600, 6400}) {
      scene::Scene scene = extremes::punch_on_cube(formulation);
      scene.contact.friction = scene::Friction{.K = 0.5, .beta = 1.0, .mu_D = 0.5};
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(extremes::punched(-0.001));
      for (int i = 0; i <= ticks; ++i) {
        const double t = static_cast<double>(i) / ticks;
        rig.to(extremes::punched(0.002 + 0.001 * t, 0.0004 * t));
      }
      friction_n.push_back(rig.region().force.tangential_n.norm());
    }
    expect_converging(friction_n, 0.01);
    EXPECT_NEAR(friction_n[3] / friction_n[4], 1.0, 0.02);
  }
}

// Recorded instants from 2 to 101: recording does not change the computation: the same force to 1e-9. As printed:
// Nothing is recorded.
TEST(ConvergenceExtremes, RecordingHasNoEffect) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::cube(formulation);
    scene.fast.rate_hz = 100.0;
    scene.compare.instants = 6;
    const auto few = fast::run(scene);
    scene.compare.instants = 51;
    const auto many = fast::run(scene);
    ASSERT_EQ(few.instants.back().time_s, many.instants.back().time_s);
    EXPECT_NEAR((few.instants.back().force_n() - many.instants.back().force_n()).norm(), 0.0,
                1e-9 * many.instants.back().force_n().norm());
    EXPECT_LE((few.instants.back().displacement_m - many.instants.back().displacement_m).norm(),
              1e-6 * many.instants.back().displacement_m.norm());
  }
}

// A depth halved thirty times, down to a picometre: the force decreases with it without a jump. As printed: The same,
// except the weights, which become 0 / 0 (E6).
TEST(ConvergenceExtremes, DepthToNothing) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::punch_on_cube(formulation));
    rig.may = StepStatus::anchors_limited;
    double before_n = 1e300;
    for (double depth_m = 0.004; depth_m > 1e-12; depth_m *= 0.5) {
      rig.to(extremes::punched(depth_m));
      const double force_n = rig.force_n().norm();
      EXPECT_LT(force_n, before_n) << depth_m;
      EXPECT_NEAR(force_n / rig.law().force_n(depth_m), 1.0, 1e-3) << depth_m;
      before_n = force_n;
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
