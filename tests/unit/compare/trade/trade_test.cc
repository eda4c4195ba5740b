// The trade: domination, its sentences, and all models on an axisymmetric scene.
#include "compare/trade/trade.h"

#include "scene/base/files.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/spring.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace touchstone::compare {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr TradeError force = &TradeRow::force_nrmse;

TradeRow row(const std::string& name, double step_us, std::optional<double> error, double uncertainty = 0.001,
             ModelFamily family = ModelFamily::paper) {
  TradeRow out{.name = name, .key = name, .label = name, .family = family};
  out.step_p50_us = out.step_p999_us = step_us;
  out.force_nrmse = out.shape_rel_l2 = {error, uncertainty};
  return out;
}

TEST(ParetoFront, IsWhatNothingDominates) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<TradeRow> rows;
    // Few different values, so that ties are common.
    std::uniform_int_distribution<int> value(1, 6);
    for (int k = 0; k < 12; ++k) rows.push_back(row(std::to_string(k), value(random), 0.01 * value(random)));
    rows.push_back(row("unmeasured", NAN, 0.001));
    rows.push_back(row("unjudged", 0.1, std::nullopt));
    const std::vector<std::size_t> front = pareto_front(rows, force);
    const auto by = dominating(rows, force);
    ASSERT_FALSE(front.empty());
    const auto error = [&](std::size_t k) { return *judged_error(rows[k].force_nrmse); };
    const auto better = [&](std::size_t a, std::size_t b) {
      return rows[a].step_p50_us <= rows[b].step_p50_us && error(a) <= error(b) &&
             (rows[a].step_p50_us < rows[b].step_p50_us || error(a) < error(b));
    };
    for (std::size_t i = 0; i < 12; ++i) {
      const bool on_front = std::find(front.begin(), front.end(), i) != front.end();
      EXPECT_EQ(on_front, !by[i].has_value());
      bool beaten = false;
      for (std::size_t j = 0; j < 12; ++j) beaten = beaten || better(j, i);
      EXPECT_EQ(beaten, by[i].has_value());
      if (!by[i]) continue;
      EXPECT_TRUE(better(*by[i], i));
      EXPECT_FALSE(by[*by[i]].has_value()) << "what dominates is named from the front";
    }
    for (std::size_t i = 12; i < rows.size(); ++i) {
      EXPECT_EQ(std::count(front.begin(), front.end(), i), 0);
      EXPECT_FALSE(by[i].has_value());
    }
    for (std::size_t k = 1; k < front.size(); ++k) {
      EXPECT_LE(rows[front[k - 1]].step_p50_us, rows[front[k]].step_p50_us);
      EXPECT_GE(error(front[k - 1]), error(front[k]));
    }
  }
}

TEST(ParetoFront, KnowsNothingBelowTheUncertainty) {
  const std::vector<TradeRow> rows = {row("slow", 10.0, 0.001, 0.01), row("fast", 1.0, 0.009, 0.01)};
  EXPECT_THAT(pareto_front(rows, force), ElementsAre(1u));
  EXPECT_EQ(dominating(rows, force)[0], std::optional<std::size_t>(1));
  EXPECT_DOUBLE_EQ(*judged_error({-0.02, 0.01}), 0.02);
  EXPECT_DOUBLE_EQ(*judged_error({0.02, std::nullopt}), 0.02);
  EXPECT_FALSE(judged_error({std::nullopt, 0.01}));
  EXPECT_FALSE(judged_error({NAN, 0.01}));
}

std::string said(std::vector<TradeRow> rows) {
  Trade trade;
  trade.rows = std::move(rows);
  std::string out;
  for (const std::string& sentence : trade_verdict(trade)) out += sentence + "\n";
  return out;
}

TEST(TradeVerdict, SaysWhichModelDominates) {
  const TradeRow paper = row("paper", 10.0, 0.3);
  EXPECT_THAT(said({paper, row("columns", 5.0, 0.02, 0.001, ModelFamily::compliance)}),
              HasSubstr("It is dominated: columns"));
  const std::string for_speed = said({paper, row("columns", 200.0, 0.02, 0.001, ModelFamily::compliance)});
  EXPECT_THAT(for_speed, HasSubstr("for its speed alone"));
  EXPECT_THAT(for_speed, HasSubstr("at 20 times the time of a step and one part in 15"));
  TradeRow late = row("columns", 200.0, 0.02, 0.001, ModelFamily::compliance);
  late.step_p999_us = 1200.0;
  EXPECT_THAT(said({paper, late}), HasSubstr("(except its slowest"));
  // A model slower than the device loop does not count.
  EXPECT_THAT(said({paper, row("columns", 5000.0, 0.02, 0.001, ModelFamily::compliance)}), HasSubstr("No other model"));
  EXPECT_THAT(said({paper, row("columns", 200.0, 0.4, 0.001, ModelFamily::compliance)}), HasSubstr("No other model"));
  EXPECT_THAT(said({paper, row("levels", 500.0, 0.001, 0.001, ModelFamily::reference)}), HasSubstr("No other model"));
  EXPECT_THAT(said({row("paper", 10.0, 0.01, 0.02)}), HasSubstr("not distinguishable"));
  EXPECT_THAT(said({row("paper", 5000.0, 0.1)}), HasSubstr("Nothing keeps up"));
  EXPECT_THAT(said({row("paper", 10.0, NAN)}), HasSubstr("The paper's model has no force that can be judged"));
  EXPECT_THAT(said({row("columns", 10.0, 0.1, 0.001, ModelFamily::compliance)}),
              HasSubstr("No row of the force is the paper's model; the absent rows say why."));
  EXPECT_THAT(said({row("paper", 10.0, 1.2)}), HasSubstr("is as accurate."));
  TradeRow shape = row("paper", 10.0, 0.3);
  shape.shape_rel_l2 = {1.2, 0.001};
  EXPECT_THAT(said({shape}), HasSubstr("is as accurate, except the rest shape"));
}

TEST(TradeSvg, NamesEveryPointThatCanBeDrawn) {
  Trade trade;
  trade.title = "A & B";
  std::mt19937 random(5);
  std::lognormal_distribution<double> spread;
  for (int k = 0; k < 20; ++k) {
    trade.rows.push_back(row("point " + std::to_string(k), spread(random), spread(random)));
  }
  trade.rows.push_back(row("nowhere", 1.0, std::nullopt));
  const std::string svg = trade_svg(trade);
  EXPECT_TRUE(testing::is_well_formed(svg));
  for (int k = 0; k < 20; ++k) EXPECT_THAT(svg, HasSubstr(">point " + std::to_string(k) + "<"));
  EXPECT_THAT(svg, Not(HasSubstr(">nowhere<")));
}

const std::string scenes = source_folder() + "/meshes/scenes/";

scene::Scene ball_on_ball(int levels) {
  return scene::load_scene(
      scenes + "sphere-on-sphere-body.toml",
      {"compare.instants=7", "fast.triangles=800", "fast.rate_hz=500.0", "reference.levels=" + std::to_string(levels)});
}

class TradeTest : public ::testing::Test {
 protected:
  Trade run(const scene::Scene& scene, TradeOptions options = {},
            const std::vector<ModelList>& models = registered_models()) {
    options.quick = true;
    return trade(
        scene, options,
        [&](const scene::Scene& one, const scene::Surface& surface, std::optional<int> levels) {
          if (one.fast.triangles != scene.fast.triangles) levels_elsewhere_.push_back(levels);
          scene::Scene asked = one;
          if (!asked.reference.levels) asked.reference.levels = 1;
          if (levels) asked.reference.levels = levels;
          reference::Options solve;
          solve.store = folder_.path() / "store";
          solve.rest_area_m2 = surface.vertex_area_m2;
          return reference::solve(asked, surface.points_m, solve);
        },
        {}, models);
  }
  static const TradeRow& find(const Trade& trade, const std::string& key) {
    const auto found =
        std::find_if(trade.rows.begin(), trade.rows.end(), [&](const TradeRow& r) { return r.key == key; });
    EXPECT_NE(found, trade.rows.end()) << key;
    return *found;
  }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_.path() / name;
    scene::write_file(file, text);
    return file;
  }

  testing::TemporaryFolder folder_;
  std::vector<std::optional<int>> levels_elsewhere_;  ///< asked for on surfaces other than the scene's
};

TEST_F(TradeTest, ATrackOfTooManyTicksIsRefusedAtOnce) {
  scene::Scene scene = ball_on_ball(1);
  const double begin_s = scene.track.front().time_s;
  scene.track.back().time_s = begin_s + 1'000'001 / scene.fast.rate_hz;
  try {
    (void)run(scene);
    FAIL() << "traded";
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("takes 1000002 ticks at fast.rate_hz = 500 Hz"));
    EXPECT_THAT(error.what(), HasSubstr("at most 1000000"));
  }
}

TEST_F(TradeTest, MeasuresAndJudgesEveryRung) {
  const scene::Scene scene = ball_on_ball(3);
  const Trade found = run(scene);
  // Other rest points do not change the meshes.
  EXPECT_THAT(levels_elsewhere_, ElementsAre(std::optional(3), std::optional(3)));
  int measured = 0;
  for (const TradeRow& one : found.rows) {
    if (!one.absent.empty()) continue;
    ++measured;
    EXPECT_GT(one.step_p50_us, 0.0) << one.key;
    EXPECT_GT(one.steps, 0) << one.key;
    EXPECT_TRUE(judged_error(one.shape_rel_l2)) << one.key;
    EXPECT_TRUE(judged_error(one.force_nrmse)) << one.key;
    EXPECT_TRUE(one.force_nrmse.uncertainty) << one.key;
    EXPECT_GT(one.memory_bytes, 0.0) << one.key;
    if (one.family == ModelFamily::reference) continue;
    EXPECT_GT(one.setup_s, 0.0) << one.key;
    EXPECT_LE(one.step_p50_us, one.step_p999_us) << one.key;
  }
  EXPECT_GE(measured, 10);
  EXPECT_THAT(find(found, "bullet").absent, HasSubstr("a cube"));

  // The scene's constants are the paper's and fit no material; the compliance fits this one.
  const TradeRow& compliance = find(found, "compliance-1");
  EXPECT_LT(*compliance.force_nrmse.value, 0.1);
  EXPECT_LT(*compliance.shape_rel_l2.value, 0.2);
  EXPECT_GT(*find(found, "published-duffing").force_nrmse.value, 0.3);
  EXPECT_THAT(trade_verdict(found).front(),
              ::testing::AnyOf(HasSubstr("It is dominated"), HasSubstr("It is less accurate")));
  // Finer meshes of the reference take longer and are more accurate.
  EXPECT_LT(find(found, "reference-1").step_p50_us, find(found, "reference-3").step_p50_us);
  EXPECT_GT(*find(found, "reference-1").shape_rel_l2.value, *find(found, "reference-2").shape_rel_l2.value);
  EXPECT_EQ(*find(found, "reference-3").force_nrmse.value, 0.0);
  EXPECT_FALSE(find(found, "reference-3").force_nrmse.distinguishable());
  EXPECT_LT(find(found, "compliance-1").step_p50_us, 0.1 * find(found, "reference-1").step_p50_us);

  write_trade(folder_.path(), found, scene::make_manifest(scene, "test"));
  const auto json = nlohmann::json::parse(*scene::read_file(folder_.path() / "summary.json"));
  EXPECT_EQ(json.at("trade.compliance-1.force.nrmse").get<double>(), *compliance.force_nrmse.value);
  EXPECT_EQ(json.at("units").at("trade.compliance-1.step_us.p999").get<std::string>(), "us");
  for (const auto& [error, what] :
       {std::pair(&TradeRow::force_nrmse, "force"), std::pair(&TradeRow::shape_rel_l2, "shape")}) {
    const std::string front = json.at(std::string("trade.front_") + what).get<std::string>();
    for (const std::size_t k : pareto_front(found.rows, error)) {
      EXPECT_THAT(front, HasSubstr(found.rows[k].key));
      EXPECT_FALSE(json.contains("trade." + found.rows[k].key + ".dominated_" + what + "_by"));
    }
  }
  EXPECT_TRUE(testing::is_well_formed(*scene::read_file(folder_.path() / "report.html")));
  EXPECT_TRUE(testing::is_well_formed(*scene::read_file(folder_.path() / "trade.svg")));
  const std::string csv = *scene::read_file(folder_.path() / "trade.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), static_cast<long>(found.rows.size()) + 1);
  EXPECT_THAT(trade_text(found), HasSubstr("absent: anchor sets"));
}

TEST_F(TradeTest, TradesAModelThatNobodyHereKnows) {
  scene::Scene scene = ball_on_ball(1);
  scene.contact.k1_n_per_m = 1.0e4;  // about as stiff as the reference
  const Trade found = run(scene, {}, {testing::springs});
  ASSERT_EQ(found.rows.size(), 2u);
  const TradeRow& spring = find(found, "spring");
  EXPECT_EQ(spring.note, "one spring");
  EXPECT_GT(spring.steps, 0);
  EXPECT_DOUBLE_EQ(*spring.shape_rel_l2.value, 1.0);  // a body that never moves
  EXPECT_GT(*spring.force_nrmse.value, 0.0);
  EXPECT_LT(*spring.force_nrmse.value, 1.0);
  EXPECT_EQ(find(found, "broken").absent, "it broke");
}

TEST_F(TradeTest, JudgesTheWorstHeldOutContactWithTunedValues) {
  const std::filesystem::path tuned = write("tuned.toml",
                                            "[contact]\nlaw = \"duffing\"\nk1_n_per_m = 2.0e4\n"
                                            "k3_n_per_m3 = 1.0e9\n[fast]\nformulation = \"corrected\"\n");
  const std::string scene_file = scenes + "sphere-on-sphere-body.toml";
  const auto contact = [&](const std::string& name, const std::string& radius, const std::string& lowest) {
    return "[[held_out]]\nname = \"" + name + "\"\ndiffers = \"tool\"\nscene = \"" + scene_file +
           "\"\nset = { compare.instants = 5, fast.triangles = 800, tool.radius_m = " + radius +
           ", \"track[1].position_m[2]\" = " + lowest + " }\n";
  };
  const auto held_out_on = [&](const std::string& contacts) {
    TradeOptions options;
    options.parameters = {tuned};
    options.held_out =
        write("study.toml", "kind = \"tuning\"\n[[training]]\nname = \"given\"\nscene = \"" + scene_file + "\"\n" +
                                contacts + "[[parameter]]\nkey = \"contact.k1_n_per_m\"\nbounds = [1.0e3, 1.0e5]\n");
    return run(ball_on_ball(1), options);
  };
  const std::string larger = contact("a little larger", "0.0102", "0.0662"),
                    half = contact("half as large", "0.005", "0.062");
  const Trade own = run(ball_on_ball(1), {.parameters = {tuned}});
  EXPECT_EQ(find(own, "tuned-tuned").force_contact, own.title);
  EXPECT_LT(*find(own, "tuned-tuned").force_nrmse.value, *find(own, "corrected-duffing").force_nrmse.value);
  const Trade first = held_out_on(larger), second = held_out_on(half), held_out = held_out_on(larger + half);
  ASSERT_EQ(held_out.contacts.size(), 2u);
  for (const char* key : {"tuned-tuned", "published-duffing", "compliance-1"}) {
    const double a = *find(first, key).force_nrmse.value, b = *find(second, key).force_nrmse.value;
    EXPECT_NE(a, b) << key;
    EXPECT_EQ(*find(held_out, key).force_nrmse.value, std::max(a, b)) << key;
    EXPECT_EQ(find(held_out, key).force_contact, a > b ? "a little larger" : "half as large") << key;
  }
  // With one mesh the uncertainty of the reference is unknown.
  EXPECT_FALSE(find(own, "reference-1").force_nrmse.value);
  EXPECT_THAT(trade_text(held_out), HasSubstr("half as large"));
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const scene::InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(TradeTest, RefusesBadInputBeforeAnyWork) {
  const scene::Scene scene = ball_on_ball(1);
  const auto with = [&](const std::string& text) {
    const std::filesystem::path file = write("bad.toml", text);
    return refusal([&] { (void)run(scene, {.parameters = {file}}); });
  };
  EXPECT_THAT(with("[contact]\nk2_n_per_m = 3.0\n"), HasSubstr("bad.toml:2:1: \"contact.k2_n_per_m\" is no parameter"));
  EXPECT_THAT(with("[contact]\nk1_n_per_m = -3.0\n"), HasSubstr("bad.toml:2:14: contact.k1_n_per_m = -3"));
  EXPECT_THAT(with("[contact]\nlaw = \"cubic\"\n"), HasSubstr("expected \"duffing\" or \"area_aware\""));
  EXPECT_THAT(with("[contact]\nlaw = \"area_aware\"\n"), HasSubstr("k1_per_radius_n_per_m2"));
  EXPECT_THAT(with("[tool]\nradius_m = 0.01\n"), HasSubstr("\"tool.radius_m\" is no parameter of the fast model"));
  EXPECT_THAT(refusal([&] { (void)run(scene, {.parameters = {"/nowhere.toml"}}); }), HasSubstr("/nowhere.toml"));
  EXPECT_THAT(refusal([&] { (void)run(scene, {.held_out = "/nowhere.toml"}); }), HasSubstr("/nowhere.toml"));
  scene::Scene apart = scene;
  for (scene::Waypoint& waypoint : apart.track) waypoint.pose.position_m.z() = 0.09;
  EXPECT_THAT(refusal([&] { (void)run(apart); }), HasSubstr("never touches"));
}

}  // namespace
}  // namespace touchstone::compare
