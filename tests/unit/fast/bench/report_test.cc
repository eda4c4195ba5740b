#include "fast/bench/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace touchstone::bench {
namespace {

using scene::BodyShape;
using testing::HasSubstr;
using testing::Not;

CaseResult result_of(const std::string& size, int regions, double step_us, double floor_us, double force_us) {
  CaseResult c;
  c.which = {BodyShape::box, size, regions};
  c.triangles = 3888;
  c.vertices = 2166;
  c.ticks = 100;
  c.regions_least = c.regions_most = regions;
  c.step = {{step_us, 2 * step_us, 3 * step_us, 4 * step_us}, step_us};
  c.floor = {{floor_us, floor_us, floor_us, floor_us}, floor_us};
  c.force = {force_us, force_us, force_us, force_us};
  c.stages[static_cast<std::size_t>(fast::Stage::detection)] = {force_us, force_us, force_us, force_us};
  c.stages[static_cast<std::size_t>(fast::Stage::normals)] = {2.0, 2.0, 2.0, 2.0};
  return c;
}

CaseResult with_response(CaseResult c) {
  c.which.response = true;
  return c;
}

/// All figures are exactly at their targets.
BenchResult at_the_targets() {
  BenchResult result;
  result.counters = "counted";
  result.peer_version = "Bullet 0.0";
  result.cases = {result_of("1k", 1, 8.0, 0.5, 5.0),
                  result_of("4k", 1, 20.0, 2.0, 10.0),
                  result_of("4k", 10, 120.0, 2.0, 100.0),
                  result_of("100k", 1, 150.0, 50.0, 6.0),
                  with_response(result_of("4k", 1, 30.0, 2.0, 10.0)),
                  with_response(result_of("100k", 1, 1000.0, 50.0, 6.0))};
  PeerResult peer;
  peer.size = "1k";
  peer.setting.name = "rubber.implicit";
  peer.sound = peer.touching = true;
  peer.ticks = 10;
  peer.step.cpu_us = 400.0;
  peer.step.wall.p50_us = 1000.0;
  peer.our_step_us = 8.0;
  result.peers = {peer};
  return result;
}

const Verdict& verdict(const std::vector<Verdict>& all, const std::string& key) {
  return *std::find_if(all.begin(), all.end(), [&](const Verdict& v) { return v.key == key; });
}

TEST(Verdicts, AreMetAtTheTargetsAndMissedBeyond) {
  std::vector<Verdict> all = verdicts(at_the_targets());
  ASSERT_EQ(all.size(), 8u);
  for (const Verdict& v : all) {
    EXPECT_TRUE(v.measured()) << v.key;
    EXPECT_DOUBLE_EQ(v.number, v.target) << v.key;
    EXPECT_TRUE(v.met()) << v.key;
  }
  for (Verdict& v : all) {
    v.number *= v.at_most ? 1.01 : 0.99;
    EXPECT_FALSE(v.met()) << v.key;
    v.number *= v.at_most ? 0.5 : 2.0;
    EXPECT_TRUE(v.met()) << v.key;
  }
}

TEST(Verdicts, WhatWasNotMeasuredIsNeitherMetNorMissed) {
  const std::vector<Verdict> all = verdicts({});
  for (const Verdict& v : all) {
    EXPECT_FALSE(v.measured()) << v.key;
    EXPECT_FALSE(v.met()) << v.key;
  }
  BenchResult result = at_the_targets();
  result.cases[2].available = false;
  EXPECT_FALSE(verdict(verdicts(result), "ten_regions_over_one_4k").measured());
  EXPECT_THAT(report_text(result), Not(HasSubstr("missed")));
}

TEST(Verdicts, TenRegionsThatAreNotTenAreNotCompared) {
  BenchResult result = at_the_targets();
  result.cases[2].regions_least = 9;
  EXPECT_FALSE(verdict(verdicts(result), "ten_regions_over_one_4k").measured());
  EXPECT_THAT(report_text(result), HasSubstr("9 to 10 regions"));
}

TEST(Verdicts, TheForceIsThatOfTheWorstNumberOfRegions) {
  BenchResult result = at_the_targets();
  result.cases[2].force.p50_us = 170.0;
  EXPECT_DOUBLE_EQ(verdict(verdicts(result), "force_us_p50_per_region").number, 17.0);
  result.cases[1].force.p50_us = 18.0;
  EXPECT_DOUBLE_EQ(verdict(verdicts(result), "force_us_p50_per_region").number, 18.0);
  // Other sizes have no effect.
  result.cases[0].force.p50_us = 99.0;
  EXPECT_DOUBLE_EQ(verdict(verdicts(result), "force_us_p50_per_region").number, 18.0);
}

TEST(Verdicts, APeerThatFailedOrComputedSomethingElseIsNotQuoted) {
  BenchResult result = at_the_targets();
  result.peers[0].touching = false;
  EXPECT_FALSE(verdict(verdicts(result), "bullet_over_step_1k").measured());
  EXPECT_THAT(report_text(result), HasSubstr("not in contact"));
  result.peers[0].touching = true;
  result.peers[0].setting.name = "pvc.explicit";
  EXPECT_FALSE(verdict(verdicts(result), "bullet_over_step_1k").measured());
}

TEST(BenchFigures, HoldTheTargetsFirstAndEveryCase) {
  const scene::Figures all = figures(at_the_targets());
  const auto find = [&](const std::string& key) -> const scene::Figure& {
    const auto at = std::find_if(all.begin(), all.end(), [&](const scene::Figure& f) { return f.key == key; });
    if (at == all.end()) throw std::runtime_error("no key " + key);
    return *at;
  };
  EXPECT_EQ(all[0].key, "step_over_floor_4k");
  EXPECT_EQ(find("bench.box.4k.10.step_us.p50").number, 120.0);
  EXPECT_EQ(find("bench.box.4k.10.step_us.p999").number, 360.0);
  EXPECT_EQ(find("bench.box.4k.10.step_us.max").number, 480.0);
  EXPECT_EQ(find("bench.box.4k.10.step_us.max").unit, "us");
  EXPECT_EQ(find("bench.box.4k.10.floor_us.p50").number, 2.0);
  EXPECT_EQ(find("bench.box.4k.10.over_floor").number, 60.0);
  EXPECT_EQ(find("bench.box.4k.1.stage.normals_us.p50").number, 2.0);
  EXPECT_EQ(find("bench.box.4k.1.stage.normals_over_floor").number, 1.0);
  EXPECT_EQ(find("bench.bullet.1k.rubber.implicit.over_step").number, 50.0);
  EXPECT_EQ(find("bench.verdict.bullet_over_step_1k").text, "met");
  EXPECT_EQ(find("force_us_p50_per_region").unit, "us");
  std::vector<std::string> keys;
  for (const scene::Figure& f : all) keys.push_back(f.key);
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end()) << "a key twice";
}

TEST(BenchReport, SaysOfAMissedTargetWhereTheTimeGoes) {
  BenchResult result = at_the_targets();
  EXPECT_THAT(report_text(result), Not(HasSubstr("Stages of the cases that missed")));
  result.cases[1].step.wall.p50_us = 24.0;
  const std::string text = report_text(result);
  EXPECT_THAT(text, HasSubstr("12.0  <= 10.0  missed"));
  EXPECT_THAT(text, HasSubstr("detection 10.0 us (83 %, 5.00 floors), normals 2.00 us (17 %, 1.00 floors)"));
}

TEST(BenchReport, ColumnsAreAligned) {
  const std::string text =
      aligned({{"case", "p50", "words"}, {"longer", "1234.5", "a"}, {"x", "a whole sentence"}}, true);
  EXPECT_EQ(text,
            "  case       p50  words\n"
            "  longer  1234.5  a\n"
            "  x       a whole sentence\n");
  EXPECT_EQ(aligned({{"a", "1"}, {"b", "10"}}), "  a   1\n  b  10\n");
}

}  // namespace
}  // namespace touchstone::bench
