#include "scene/output/results.h"

#include "scene/base/error.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

namespace touchstone::scene {
namespace {

class ResultFolder : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = std::filesystem::path(testing::TempDir()) /
           ("results-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream in(dir_ / name);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  std::filesystem::path dir_;
};

TEST_F(ResultFolder, CsvReadsBackExactly) {
  write_csv(dir_ / "c.csv", {{"a_m", {1.0 / 3.0, 2.0}}, {"b_n", {-1e-300, 0.1}}});
  std::istringstream in(read("c.csv"));
  std::string header, cell;
  std::getline(in, header);
  EXPECT_EQ(header, "a_m,b_n");
  std::getline(in, cell, ',');
  EXPECT_EQ(std::stod(cell), 1.0 / 3.0);
  std::getline(in, cell);
  EXPECT_EQ(std::stod(cell), -1e-300);
}

TEST_F(ResultFolder, SummaryIsFlatWithUnitsForEveryKey) {
  write_summary(dir_ / "s.json", {{"force.nrmse", 0.25, "", ""},
                                  {"fast.step_us.p50", 12.5, "", "us"},
                                  {"fast.status", 0, "ok", ""},
                                  {"x", NAN, "", ""}});
  const auto json = nlohmann::json::parse(read("s.json"));
  EXPECT_EQ(json["force.nrmse"], 0.25);
  EXPECT_EQ(json["fast.status"], "ok");
  EXPECT_TRUE(json["x"].is_null());
  EXPECT_EQ(json["units"]["fast.step_us.p50"], "us");
  EXPECT_EQ(json["units"].size() + 1, json.size());
}

TEST_F(ResultFolder, ANumberThatIsNotKnownIsNullWithTheReasonBesideIt) {
  write_summary(dir_ / "s.json", {{"force.nrmse_uncertainty", NAN, "unknown", ""},
                                  {"fit.condition", INFINITY, "infinite", ""},
                                  {"fast.status", 0, "ok", ""}});
  const auto json = nlohmann::json::parse(read("s.json"));
  EXPECT_TRUE(json["force.nrmse_uncertainty"].is_null());
  EXPECT_TRUE(json["fit.condition"].is_null());
  EXPECT_EQ(json["reasons"], nlohmann::json({{"force.nrmse_uncertainty", "unknown"}, {"fit.condition", "infinite"}}));
  EXPECT_EQ(json["fast.status"], "ok");
  EXPECT_EQ(json["units"].size(), 3u);
}

TEST_F(ResultFolder, CsvSaysNanWithoutASign) {
  write_csv(dir_ / "c.csv", {{"a_n", {NAN, std::copysign(NAN, -1.0), 1.0}}});
  EXPECT_EQ(read("c.csv"), "a_n\nnan\nnan\n1\n");
}

TEST_F(ResultFolder, RecordsBecomeColumnsOfEqualLength) {
  std::vector<InstantRecord> records(3);
  records[1].regions.push_back({0.002, Vec3(1, 2, 3), Vec3(4, 5, 6), 7e-6});
  records[1].depth_m = 0.002;
  const auto columns = record_columns(records, "fast_");
  for (const Column& c : columns) EXPECT_EQ(c.values.size(), 3u) << c.name;
  const auto value = [&](const std::string& name) {
    for (const Column& c : columns) {
      if (c.name == name) return c.values[1];
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  EXPECT_EQ(value("fast_region0_force_z_n"), 3.0);
  EXPECT_EQ(value("fast_region0_torque_x_nm"), 4.0);
  EXPECT_EQ(value("fast_region0_area_m2"), 7e-6);
}

TEST_F(ResultFolder, CarriesItsMeshToolWhereverItIsMoved) {
  const std::filesystem::path shipped = source_folder() + "/meshes";
  const std::filesystem::path inputs = dir_ / "inputs", made = dir_ / "made", moved = dir_ / "far" / "away";
  for (const auto& folder : {inputs / "tools", inputs / "scenes", made, moved.parent_path()}) {
    std::filesystem::create_directories(folder);
  }
  std::filesystem::copy(shipped / "tools/mallet.stl", inputs / "tools");
  std::filesystem::copy(shipped / "scenes/mallet-head-on-cube.toml", inputs / "scenes");
  const Scene scene = load_scene(inputs / "scenes/mallet-head-on-cube.toml");
  std::filesystem::remove_all(inputs);  // even before the results are written
  write_manifest(made / "manifest.json", make_manifest(scene, "touchstone fast"));
  std::filesystem::rename(made, moved);
  EXPECT_EQ(read_file(moved / "tool.stl"), read_file(shipped / "tools/mallet.stl"));
  const auto manifest = nlohmann::json::parse(read_file(moved / "manifest.json").value());
  EXPECT_EQ(manifest["title"], "A mallet's head pressed on a rubber cube (paper, Fig. 15)");
  const Scene again = parse_scene(manifest["resolved_scene"], moved / "manifest.json");
  EXPECT_EQ(scene_hash(again), scene_hash(scene));
  EXPECT_EQ(manifest["scene_hash"], scene_hash(scene));
}

TEST(Stopwatch, ReadsShortStages) {
  const Stopwatch watch;
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const StageTime time = watch.read("stage");
  EXPECT_EQ(time.stage, "stage");
  EXPECT_GE(time.wall_s, 0.002);
  EXPECT_GE(time.cpu_s, 0.0);
}

TEST_F(ResultFolder, UnusableFolderIsOneMessage) {
  std::ofstream(dir_ / "file") << "x";
  EXPECT_THROW((void)prepare_result_folder(dir_ / "file" / "below"), InputError);
  EXPECT_THROW((void)prepare_result_folder("/proc/touchstone"), InputError);
  EXPECT_NO_THROW((void)prepare_result_folder(dir_ / "new" / "deep"));
}

TEST_F(ResultFolder, OneRunWritesAtATime) {
  write_file(dir_ / "other.csv.touchstone-part-1-1", "half");
  {
    const FolderLock mine = prepare_result_folder(dir_);
    EXPECT_FALSE(std::filesystem::exists(dir_ / "other.csv.touchstone-part-1-1"));
    write_file(dir_ / "curve.csv.touchstone-part-1-1", "half");
    try {
      (void)prepare_result_folder(dir_);
      ADD_FAILURE() << "two writers";
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(),
                "--out " + dir_.string() +
                    ": another run is writing there; expected a folder of its own, or to be run after it");
    }
    EXPECT_TRUE(std::filesystem::exists(dir_ / "curve.csv.touchstone-part-1-1")) << "the other run's";
    const FolderLock below = prepare_result_folder(dir_ / "below");
    const FolderLock worker(dir_);  // of a study, whose commands use the folder
  }
  EXPECT_NO_THROW((void)prepare_result_folder(dir_));
}

TEST_F(ResultFolder, NamesOfAnyBytesBecomeJson) {
  Manifest manifest = make_manifest(Scene{}, "touchstone live");
  manifest.entries.emplace_back("log", "l\xff.csv");
  write_manifest(dir_ / "manifest.json", manifest);
  write_summary(dir_ / "summary.json", {{"name", 0.0, "\xc3(", ""}});
  EXPECT_EQ(nlohmann::json::parse(read("manifest.json"))["log"], "l\uFFFD.csv");
  EXPECT_EQ(nlohmann::json::parse(read("summary.json"))["name"], "\uFFFD(");
}

TEST_F(ResultFolder, AFailedWriteLeavesNothingHalfWritten) {
  EXPECT_THROW(write_file(dir_ / "missing" / "f", "x"), std::filesystem::filesystem_error);
  write_file(dir_ / "f", "new");
  EXPECT_EQ(read("f"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_), {}), 1);
}

}  // namespace
}  // namespace touchstone::scene
