#include "compare/errors/moved_surface.h"

#include "reference/tool/tool_distance.h"

#include "support/synthetic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

using scene::Vec3;

scene::Surface cube() { return scene::tessellate(scene::Box(Vec3(0.0, 0.0, 0.5), Vec3::Ones()), 300); }

TEST(MovedSurface, VolumeFollowsTheDeterminantOfALinearMove) {
  const scene::Surface surface = cube();
  const Eigen::Index n = surface.points_m.cols();
  EXPECT_NEAR(enclosed_volume_m3(surface, Eigen::Matrix3Xd::Zero(3, n)), 1.0, 1e-12);
  scene::Mat3 stretch;
  stretch << 1.2, 0.1, 0.0, 0.0, 0.9, 0.2, 0.0, 0.0, 1.1;
  const Eigen::Matrix3Xd moved_m = stretch * surface.points_m - surface.points_m;
  EXPECT_NEAR(enclosed_volume_m3(surface, moved_m), 1.2 * 0.9 * 1.1, 1e-12);
  const Eigen::Matrix3Xd shifted_m = Vec3(3.0, -2.0, 7.0).replicate(1, n);
  EXPECT_NEAR(enclosed_volume_m3(surface, shifted_m), 1.0, 1e-11);
}

TEST(MovedSurface, HausdorffOfAShiftIsTheShift) {
  const scene::Surface surface = cube();
  const Eigen::Index n = surface.points_m.cols();
  const Eigen::Matrix3Xd rest_m = Eigen::Matrix3Xd::Zero(3, n);
  const Eigen::Matrix3Xd shifted_m = Vec3(0.03, 0.0, 0.0).replicate(1, n);
  EXPECT_NEAR(hausdorff_m(surface, rest_m, shifted_m), 0.03, 1e-12);
  EXPECT_NEAR(hausdorff_m(surface, shifted_m, rest_m), 0.03, 1e-12);
  EXPECT_EQ(hausdorff_m(surface, shifted_m, shifted_m), 0.0);
}

TEST(MovedSurface, HausdorffDoesNotSeePointsThatSlideAlongTheSurface) {
  const scene::Surface surface = cube();
  const Eigen::Index n = surface.points_m.cols();
  Eigen::Matrix3Xd slid_m = Eigen::Matrix3Xd::Zero(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = surface.points_m.col(i);
    if (p.z() > 1.0 - 1e-9 && std::abs(p.x()) < 0.4 && std::abs(p.y()) < 0.4) slid_m(0, i) = 0.05;
  }
  EXPECT_NEAR(hausdorff_m(surface, Eigen::Matrix3Xd::Zero(3, n), slid_m), 0.0, 1e-12);
}

TEST(MovedSurface, HausdorffLooksBothWays) {
  // A spike on one side only: the flat side's vertices are all near the other surface, but not the reverse.
  const scene::Surface surface = cube();
  const Eigen::Index n = surface.points_m.cols();
  const Eigen::Matrix3Xd flat_m = Eigen::Matrix3Xd::Zero(3, n);
  Eigen::Matrix3Xd spike_m = flat_m;
  Eigen::Index top = 0;
  ((surface.points_m.colwise() - Vec3(0.0, 0.0, 1.0)).colwise().norm()).minCoeff(&top);
  spike_m(2, top) = 0.5;
  EXPECT_NEAR(hausdorff_m(surface, flat_m, spike_m), 0.5, 1e-12);
  EXPECT_NEAR(hausdorff_m(surface, spike_m, flat_m), 0.5, 1e-12);
}

TEST(MovedSurface, HausdorffOfABrokenPlaceIsNotANumber) {
  const scene::Surface surface = cube();
  const Eigen::Matrix3Xd rest_m = Eigen::Matrix3Xd::Zero(3, surface.points_m.cols());
  Eigen::Matrix3Xd broken_m = rest_m;
  broken_m(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(hausdorff_m(surface, rest_m, broken_m)));
}

TEST(MovedSurface, GapsAreTakenInTheToolFrame) {
  scene::Surface surface;
  surface.points_m.resize(3, 2);
  surface.points_m.col(0) = Vec3(0.0, 3.05, 0.0);  // outside the long end of the rotated tool
  surface.points_m.col(1) = Vec3(3.0, 1.0, 0.0);   // where that end would be without the rotation
  Eigen::Matrix3Xd moved_m = Eigen::Matrix3Xd::Zero(3, 2);
  scene::Tool box;
  box.shape = scene::ToolShape::box;
  box.size_m = Vec3(4.0, 1.0, 1.0);
  const auto tool = reference::tool_distance(box);
  scene::Pose pose;
  pose.position_m = Vec3(0.0, 1.0, 0.0);
  pose.orientation = Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ());
  EXPECT_NEAR(tool_gaps_m(surface, moved_m, *tool, pose)[0], 0.05, 1e-12);
  EXPECT_NEAR(tool_gaps_m(surface, moved_m, *tool, pose)[1], 2.5, 1e-12);
  moved_m(1, 0) = -0.15;
  EXPECT_NEAR(tool_gaps_m(surface, moved_m, *tool, pose)[0], -0.10, 1e-12);
}

}  // namespace
}  // namespace touchstone::compare
