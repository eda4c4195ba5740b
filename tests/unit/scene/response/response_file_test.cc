// Response files: what is read back, and what is refused.
#include "scene/response/response_file.h"

#include "scene/base/error.h"
#include "scene/base/files.h"
#include "support/press.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ResponseFile : public ::testing::Test {
 protected:
  ResponseFile() {
    response_.grid = load_grid(scene_).grid.value();
    const int n = response_.grid.count();
    response_.loads = {.friction = true, .ball = true};
    response_.smooth_m_per_n = Eigen::MatrixXf::Random(15, 4 * n);
    response_.own_m_per_n = Eigen::Matrix3Xd::Random(3, 4 * n);
    response_.tilt_per_n = Eigen::Matrix2Xd::Random(2, n);
    response_.unknowns = 77;
    response_.interpolation_rel = 0.003;
    bytes_ = response_bytes(response_, "body");
  }
  static void expect_refused(const std::string& bytes, const std::string& why, const std::string& identity = "body") {
    EXPECT_THAT([&] { (void)response_from(bytes, identity); }, ThrowsMessage<InputError>(HasSubstr(why)));
  }

  Scene scene_ = test::ball_on_cube();
  Response response_;
  std::string bytes_;
};

TEST_F(ResponseFile, ReadsBackWhatWasWritten) {
  const Response read = response_from(bytes_, "body");
  EXPECT_EQ(read.smooth_m_per_n, response_.smooth_m_per_n);
  EXPECT_EQ(read.own_m_per_n, response_.own_m_per_n);
  EXPECT_EQ(read.tilt_per_n, response_.tilt_per_n);
  EXPECT_EQ(read.grid.points_m, response_.grid.points_m);
  EXPECT_EQ(read.grid.normals, response_.grid.normals);
  EXPECT_EQ(read.grid.axes, response_.grid.axes);
  EXPECT_EQ(read.grid.counts, response_.grid.counts);
  EXPECT_EQ(read.grid.spacing_m, response_.grid.spacing_m);
  EXPECT_EQ(read.unknowns, 77);
  EXPECT_EQ(read.interpolation_rel, 0.003);
  EXPECT_EQ(response_bytes(read, "body"), bytes_);
}

TEST_F(ResponseFile, RefusesWhatItIsNot) {
  expect_refused("", "no response file");
  expect_refused("solid cube", "no response file");
  expect_refused("touchstone response 99: m\n", "another version");
  expect_refused(bytes_, "another body", "other body");
  for (const std::size_t left : {std::size_t{30}, std::size_t{60}, std::size_t{100}, bytes_.size() - 1}) {
    EXPECT_THROW((void)response_from(bytes_.substr(0, left), "body"), InputError) << left;
  }
  expect_refused(bytes_ + "x", "checksum");
  for (const std::size_t place : {std::size_t{40}, std::size_t{80}, std::size_t{110}, bytes_.size() / 2}) {
    std::string altered = bytes_;
    altered[place] = static_cast<char>(altered[place] ^ 1);
    EXPECT_THROW((void)response_from(altered, "body"), InputError) << place;
  }
}

TEST_F(ResponseFile, RefusesNumbersThatAreNotFinite) {
  response_.own_m_per_n(1, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_refused(response_bytes(response_, "body"), "not finite");
}

TEST_F(ResponseFile, NamesTheFile) {
  const compare::testing::TemporaryFolder folder;
  const auto file = response_path(folder.path(), "body");
  std::filesystem::create_directories(file.parent_path());
  write_file(file, bytes_.substr(0, bytes_.size() - 8));
  EXPECT_THAT([&] { (void)read_response(file, "body"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr("cut short"))));
  EXPECT_THROW((void)read_response(folder.path(), "body"), InputError);
}

TEST_F(ResponseFile, IdentityIsEverythingThatCounts) {
  const Surface surface = tessellate(*body_shape(scene_.body), 400);
  const std::string identity = response_identity(scene_.body, response_.grid, surface);
  Body other = scene_.body;
  other.material.poissons_ratio = 0.3;
  EXPECT_NE(response_identity(other, response_.grid, surface), identity);
  EXPECT_NE(response_identity(scene_.body, response_.grid, surface, {.friction = true}), identity);
  other = scene_.body;
  other.size_m.z() = 0.05;
  EXPECT_NE(response_identity(other, response_.grid, surface), identity);
  EXPECT_NE(response_identity(scene_.body, response_.grid, tessellate(*body_shape(scene_.body), 800)), identity);
  LoadGrid moved = response_.grid;
  moved.points_m(0, 0) += 1e-6;
  EXPECT_NE(response_identity(scene_.body, moved, surface), identity);
  // A softer law or another tool on the same track is the same body.
  Scene softer = scene_;
  softer.contact.k1_n_per_m = 1.0;
  softer.tool.mass_kg = 2.0;
  EXPECT_EQ(response_identity(softer.body, load_grid(softer).grid.value(), surface), identity);
}

TEST(LoadGrid, LiesUnderTheTrack) {
  Scene scene = test::ball_on_cube();
  scene.track = {{0.0, test::pressed(0.003, -0.010, 0.002)}, {1.0, test::pressed(0.003, 0.010, 0.002)}};
  const LoadGrid grid = load_grid(scene).grid.value();
  EXPECT_EQ(grid.counts, (std::array{6, 3}));
  EXPECT_NEAR(grid.points_m.row(0).minCoeff(), -0.013, 1e-12);
  EXPECT_NEAR(grid.points_m.row(0).maxCoeff(), 0.013, 1e-12);
  EXPECT_NEAR(grid.points_m.row(1).mean(), 0.002, 1e-12);
  for (int k = 0; k < grid.count(); ++k) {
    EXPECT_NEAR(grid.points_m(2, k), 0.06, 1e-12);
    const Eigen::Vector2d place = grid.place(grid.points_m.col(k));
    EXPECT_NEAR(place[0], k % 6, 1e-9);
    EXPECT_NEAR(place[1], k / 6, 1e-9);
  }
  // On a ball the points are on its surface.
  const LoadGrid round = load_grid(test::ball_on_sphere()).grid.value();
  for (int k = 0; k < round.count(); ++k) {
    EXPECT_NEAR((round.points_m.col(k) - Vec3(0.0, 0.0, 0.03)).norm(), 0.03, 1e-12);
    EXPECT_NEAR(round.normals.col(k).dot(round.points_m.col(k) - Vec3(0.0, 0.0, 0.03)), 0.03, 1e-12);
  }
}

TEST(LoadGrid, SaysWhyThereIsNone) {
  Scene scene = test::ball_on_cube();
  scene.track = {{0.0, test::pressed(0.003, 0.028)}, {1.0, test::pressed(0.003, 0.029)}};
  EXPECT_THAT(load_grid(scene).why, HasSubstr("from the edges"));
  scene.track = {{0.0, test::pressed(-0.003)}, {1.0, test::pressed(-0.002)}};
  EXPECT_THAT(load_grid(scene).why, HasSubstr("the tool touches the body"));
  scene = test::ball_on_cube();
  scene.tool.shape = ToolShape::box;
  scene.tool.size_m = Vec3(0.02, 0.02, 0.02);
  EXPECT_THAT(load_grid(scene).why, HasSubstr("its tool is a ball"));
  scene.tool.shape = ToolShape::cylinder;
  scene.tool.length_m = 0.02;
  scene.tool.edge_radius_m = 0.002;
  EXPECT_EQ(load_grid(scene).why, "");
  for (Waypoint& waypoint : scene.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(0.1, Vec3::UnitX());
  }
  EXPECT_THAT(load_grid(scene).why, HasSubstr("upright"));
}

}  // namespace
}  // namespace touchstone::scene
