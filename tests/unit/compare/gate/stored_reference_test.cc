// Reference data is read back unchanged, or the reason for a refusal is given.
#include "compare/gate/stored_reference.h"

#include "compare/errors/compute_errors.h"
#include "compare/errors/errors.h"
#include "scene/base/files.h"
#include "scene/base/hash.h"
#include "scene/base/text.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

class StoredReferenceTest : public ::testing::Test {
 protected:
  void SetUp() override { store_reference(folder(), sides_.scene, sides_.run.surface, sides_.result, "make it"); }
  [[nodiscard]] std::filesystem::path folder() const { return temporary_.path() / "data"; }
  [[nodiscard]] std::string refusal(const scene::Scene& scene, const scene::Surface& surface) const {
    try {
      (void)stored_reference(folder(), scene, surface);
    } catch (const UnusableReference& error) {
      return error.what();
    }
    return "used";
  }

  testing::TemporaryFolder temporary_;
  testing::Sides sides_ = testing::pressed(5, 500);
};

TEST_F(StoredReferenceTest, ComesBackAsItWas) {
  const reference::Result back = stored_reference(folder(), sides_.scene, sides_.run.surface);
  ASSERT_EQ(back.instants.size(), sides_.result.instants.size());
  for (std::size_t t = 0; t < back.instants.size(); ++t) {
    const scene::InstantRecord &was = sides_.result.instants[t], &is = back.instants[t];
    EXPECT_EQ(is.time_s, was.time_s);
    EXPECT_EQ(is.tool.position_m, was.tool.position_m);
    EXPECT_EQ(is.tool.orientation.coeffs(), was.tool.orientation.coeffs());
    EXPECT_EQ(is.depth_m, was.depth_m);
    EXPECT_EQ(is.force_n(), was.force_n());
    EXPECT_EQ(is.support_force_n, was.support_force_n);
    EXPECT_EQ(is.regions.size(), was.regions.size());
    EXPECT_EQ(back.instants[t].region_middles_m, sides_.result.instants[t].region_middles_m);
    EXPECT_EQ(back.instants[t].force_uncertainty_n, sides_.result.instants[t].force_uncertainty_n);
    EXPECT_EQ(back.instants[t].equilibrium_rel, sides_.result.instants[t].equilibrium_rel);
    const double largest_m = was.displacement_m.cwiseAbs().maxCoeff();
    EXPECT_LE((is.displacement_m - was.displacement_m).cwiseAbs().maxCoeff(), 6e-8 * largest_m);
  }
  EXPECT_EQ(back.model, sides_.result.model);
  EXPECT_EQ(back.levels.size(), sides_.result.levels.size());
}

TEST_F(StoredReferenceTest, GivesTheSameErrors) {
  const reference::Result back = stored_reference(folder(), sides_.scene, sides_.run.surface);
  const Errors was = compute_errors(sides_.scene, sides_.run, sides_.result.instants);
  const Errors is = compute_errors(sides_.scene, sides_.run, back.instants);
  EXPECT_EQ(is.force_nrmse.value, was.force_nrmse.value);
  EXPECT_EQ(is.force_nrmse.uncertainty, was.force_nrmse.uncertainty);
  EXPECT_NEAR(*is.shape_rel_l2.value, *was.shape_rel_l2.value, 1e-6);
  EXPECT_NEAR(*is.shape_rel_l2.uncertainty, *was.shape_rel_l2.uncertainty, 1e-6);
}

TEST_F(StoredReferenceTest, SeveralRegionsAndFrictionComeBackInTheirOrder) {
  scene::InstantRecord& record = sides_.result.instants[3];
  const scene::Vec3 none = scene::Vec3::Zero();
  record.regions = {{1e-3, {1, 2, 3}, {4, 5, 6}, 7e-6, 2, {0.1, 0.2, 0.3}, true},
                    {2e-3, {-1, 0, 9}, none, 1e-6, 0, none, false}};
  sides_.result.instants[3].region_middles_m = {{0.01, 0, 0.06}, {-0.01, 0, 0.06}};
  sides_.result.instants[4].region_middles_m.clear();
  SetUp();
  const reference::Result back = stored_reference(folder(), sides_.scene, sides_.run.surface);
  EXPECT_TRUE(back.instants[4].region_middles_m.empty());
  EXPECT_FALSE(back.instants[4].regions.empty());
  const auto& regions = back.instants[3].regions;
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].id, 2);
  EXPECT_TRUE(regions[0].sliding);
  EXPECT_EQ(regions[0].torque_nm, scene::Vec3(4, 5, 6));
  EXPECT_EQ(regions[0].friction_n, scene::Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(regions[1].id, 0);
  EXPECT_EQ(back.instants[3].region_middles_m, sides_.result.instants[3].region_middles_m);
}

TEST_F(StoredReferenceTest, IsStaleForAnotherSceneButNotForAnotherFastModel) {
  scene::Scene scene = sides_.scene;
  scene.contact.k1_n_per_m *= 2.0;
  scene.title = "another title";
  EXPECT_EQ(refusal(scene, sides_.run.surface), "used");
  scene.body.material.youngs_modulus_pa *= 1.05;
  EXPECT_THAT(refusal(scene, sides_.run.surface), HasSubstr("stale"));
  scene::Surface moved = sides_.run.surface;
  moved.points_m(0, 0) += 1e-6;
  EXPECT_THAT(refusal(sides_.scene, moved), HasSubstr("other rest points"));
}

TEST_F(StoredReferenceTest, WhatIsMissingIsNotUsed) {
  for (const char* name : {"curve.csv", "surface.f32.z", "reference.json"}) {
    SetUp();
    EXPECT_EQ(refusal(sides_.scene, sides_.run.surface), "used");
    std::filesystem::remove(folder() / name);
    EXPECT_THAT(refusal(sides_.scene, sides_.run.surface), HasSubstr("missing")) << name;
  }
}

TEST_F(StoredReferenceTest, ANumberWrittenOverIsNotUsed) {
  std::string text = *scene::read_file(folder() / "curve.csv");
  char& digit = text[text.find_first_of("123456789", text.find('\n'))];
  digit = digit == '1' ? '2' : '1';
  scene::write_file(folder() / "curve.csv", text);
  EXPECT_THAT(refusal(sides_.scene, sides_.run.surface), HasSubstr("altered"));
}

TEST_F(StoredReferenceTest, WhatNoSolverGivesIsRefusedInPlainText) {
  // The refusal of a file in which one text is replaced by another and the checksum is right.
  const auto refusal_with = [&](const char* name, const std::string& that, const std::string& with) {
    SetUp();
    std::string text = *scene::read_file(folder() / name), about = *scene::read_file(folder() / "reference.json");
    const std::string checksum = scene::hash_text(text);
    text.replace(text.find(that), that.size(), with);
    scene::write_file(folder() / name, text);
    if (const std::size_t at = about.find(checksum); at != std::string::npos) {
      scene::write_file(folder() / "reference.json", about.replace(at, checksum.size(), scene::hash_text(text)));
    }
    return refusal(sides_.scene, sides_.run.surface);
  };
  const std::string unplain = refusal_with("reference.json", "\"format\"", "\"\xff");
  EXPECT_THAT(unplain, HasSubstr("reference.json"));
  EXPECT_TRUE(scene::is_plain_text(unplain)) << unplain;
  EXPECT_THAT(refusal_with("reference.json", "\"unknowns\": ", "\"unknowns\": 1e300, \"x\": "),
              HasSubstr("expected a whole number, found 1e+300"));
  const std::string curve = *scene::read_file(folder() / "curve.csv");
  const std::string head = curve.substr(0, curve.find('\n'));
  EXPECT_THAT(refusal_with("curve.csv", curve, head + "\n"), HasSubstr("holds 0 instants, the scene 5"));
  for (const char* count : {"nan", "-1", "0.5", "1e300"}) {
    std::string more = curve;
    for (std::size_t at = more.find('\n'); at != std::string::npos; at = more.find('\n', at + 1)) {
      if (at + 1 < more.size()) more.insert(at + 1, std::string(count) + ",");
    }
    EXPECT_THAT(refusal_with("curve.csv", curve, "regions," + more.replace(more.find(",regions,"), 9, ",was,")),
                AllOf(HasSubstr("column regions"), AnyOf(HasSubstr("whole number"), HasSubstr("not finite"))))
        << count;
  }
  sides_.result.instants[2].displacement_m(0, 0) = std::numeric_limits<double>::infinity();
  SetUp();
  EXPECT_THAT(refusal(sides_.scene, sides_.run.surface), HasSubstr("displacement that is not finite"));
}

TEST_F(StoredReferenceTest, AnUnknownUncertaintyIsReadBackAsUnknown) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  testing::set_all(sides_.result, &scene::ReferenceInstant::force_uncertainty_n, unknown);
  for (scene::ReferenceInstant& instant : sides_.result.instants)
    instant.displacement_uncertainty_m.setConstant(unknown);
  sides_.result.force_uncertainty_rel = sides_.result.shape_uncertainty_rel = unknown;
  store_reference(folder(), sides_.scene, sides_.run.surface, sides_.result, "test");
  const reference::Result back = stored_reference(folder(), sides_.scene, sides_.run.surface);
  EXPECT_TRUE(std::isnan(back.instants[2].force_uncertainty_n));
  EXPECT_TRUE(std::isnan(back.instants[2].displacement_uncertainty_m[0]));
  ASSERT_TRUE(back.force_uncertainty_rel && back.shape_uncertainty_rel)
      << "as if there were nothing to be uncertain of";
  EXPECT_TRUE(std::isnan(*back.force_uncertainty_rel));
  EXPECT_TRUE(std::isnan(*back.shape_uncertainty_rel));
}

}  // namespace
}  // namespace touchstone::compare
