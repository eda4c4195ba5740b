// Gates: what turns them red, what a proof shows, and who may widen a limit.
#include "compare/gate/gate.h"

#include "compare/app/gate_verb.h"
#include "compare/gate/gate_limits.h"
#include "compare/gate/gate_report.h"
#include "fast/command/command_line.h"
#include "scene/base/files.h"
#include "support/source_folder.h"
#include "support/spring.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

namespace touchstone::compare {
namespace {

using std::filesystem::path;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using namespace std::chrono_literals;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
const std::string scenes = source_folder() + "/meshes/scenes/";

Gate truth(double limit) { return {"g", GateKind::truth, "force.nrmse", limit, "", "because", {"a=1"}, {}}; }
Gate drift(double limit) { return {"g", GateKind::drift, "force.peak_fast_n", limit, "N", "because", {"a=1"}, {}}; }
scene::Figures error_of(double value, double uncertainty) {
  return {{"force.nrmse", value, "", ""}, {"force.nrmse_uncertainty", uncertainty, "", ""}};
}

TEST(Judge, TheUncertaintyCountsAgainstATruthWhateverTheSignOfTheError) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(judge("f", truth(0.0301), error_of(sign * 0.02, 0.01), nullptr, "").passes());
    const GateRecord record = judge("f", truth(0.0299), error_of(sign * 0.02, 0.01), nullptr, "");
    EXPECT_FALSE(record.passes());
    EXPECT_TRUE(record.failure.empty());
    EXPECT_NEAR(record.margin(), -0.0001, 1e-12);
  }
}

TEST(Judge, WhatIsNoFiniteNumberIsRed) {
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_FALSE(judge("f", truth(1e300), error_of(bad, 0.0), nullptr, "").passes());
    EXPECT_FALSE(judge("f", truth(1e300), error_of(0.0, bad), nullptr, "").passes());
    const AcceptedValue accepted{bad, "N", "hash"};
    EXPECT_FALSE(judge("f", drift(1e300), {{"force.peak_fast_n", bad, "", "N"}}, &accepted, "hash").passes());
  }
}

TEST(Judge, WhatIsMissingIsRedAndNamed) {
  const auto why = [](const scene::Figures& figures) { return judge("f", truth(1.0), figures, nullptr, "").failure; };
  EXPECT_THAT(why({}), HasSubstr("there is no figure force.nrmse"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "undefined: never in contact", ""}}), HasSubstr("never in contact"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "", ""}}), HasSubstr("no uncertainty"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "", ""}, {"force.nrmse_uncertainty", 0.0, "unknown", ""}}),
              HasSubstr("no uncertainty"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "", ""}, {"force.nrmse_uncertainty", nan, "", ""}}),
              HasSubstr("no uncertainty"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "", ""}, {"force.nrmse_uncertainty", nan, "unknown", ""}}),
              HasSubstr("no uncertainty"));
  EXPECT_THAT(why({{"force.nrmse", 0.0, "", "N"}, {"force.nrmse_uncertainty", 0.0, "", "N"}}), HasSubstr("unit"));
}

TEST(Judge, ADriftIsFromTheAcceptedValueOfTheSameScene) {
  const AcceptedValue accepted{100.0, "N", "hash"};
  const auto at = [&](double value, const AcceptedValue* of, const std::string& hash) {
    return judge("f", drift(0.5), {{"force.peak_fast_n", value, "", "N"}}, of, hash);
  };
  EXPECT_TRUE(at(100.49, &accepted, "hash").passes());
  EXPECT_TRUE(at(99.51, &accepted, "hash").passes());
  EXPECT_FALSE(at(100.51, &accepted, "hash").passes());
  EXPECT_FALSE(at(99.49, &accepted, "hash").passes());
  EXPECT_THAT(at(100.0, nullptr, "hash").failure, HasSubstr("--accept f.g"));
  EXPECT_THAT(at(100.0, &accepted, "other").failure, HasSubstr("stale"));
}

/// A folder with one gate on a short run of the fast model alone.
class GateFolderTest : public ::testing::Test {
 protected:
  GateFolderTest() { write("one.toml", gate_text("1e-6", "contact.k3_n_per_m3=3.1e8")); }

  static std::string gate_text(const std::string& limit, const std::string& red) {
    return "title = \"t\"\nrun = \"fast\"\nscene = \"" + scenes +
           "ball-on-cube-press.toml\"\nset = [\"fast.triangles=200\", \"compare.instants=3\"]\n[[gate]]\n"
           "name = \"peak\"\nkind = \"drift\"\nquantity = \"force.peak_fast_n\"\nlimit = " +
           limit + "\nunit = \"N\"\nreason = \"because\"\nred = [\"" + red + "\"]\n";
  }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder() / name).parent_path());
    std::ofstream(folder() / name) << text;
  }
  [[nodiscard]] path folder() const { return temporary_.path() / "gates"; }
  [[nodiscard]] GateFolder loaded() const { return load_gates(folder()); }
  void accept_all() const { (void)accept(loaded(), run_gates(loaded(), {})); }
  [[nodiscard]] int verb(GateOptions options) const {
    options.folder = folder();
    options.out = temporary_.path() / "out";
    options.quiet = true;
    return gate(options, "touchstone gate");
  }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)loaded();
    } catch (const scene::InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  void commit() const {
    const std::string git = "git -C " + temporary_.path().string() + " -c user.name=n -c user.email=e@e ";
    ASSERT_EQ(std::system((git + "init -q && " + git + "add -A && " + git + "commit -qm all").c_str()), 0);
  }

  testing::TemporaryFolder temporary_;
};

TEST_F(GateFolderTest, IsRedUntilItsValueIsAcceptedAndWhenItMoves) {
  EXPECT_EQ(verb({}), fast::answer_is_no);
  EXPECT_EQ(verb({.names = {"one.peak"}, .accept = true}), fast::done);
  EXPECT_EQ(verb({}), fast::done);
  auto json = nlohmann::json::parse(*scene::read_file(folder() / "reference/accepted.json"));
  json["one.peak"]["value"] = json["one.peak"]["value"].get<double>() + 1e-5;
  write("reference/accepted.json", json.dump());
  EXPECT_EQ(verb({}), fast::answer_is_no);
}

TEST_F(GateFolderTest, AcceptingAndRegeneratingAskForNames) {
  EXPECT_THROW((void)verb({.accept = true}), scene::InputError);
  EXPECT_THROW((void)verb({.regenerate = true}), scene::InputError);
  EXPECT_THROW((void)verb({.names = {"one.pek"}}), scene::InputError);
}

TEST_F(GateFolderTest, AChangeProvesAGateOnlyByANumberBeyondItsLimit) {
  accept_all();
  const auto proof = [&](const std::string& red) {
    write("one.toml", gate_text("1e-6", red));
    const GateFolder folder = loaded();
    return prove_gates(folder, run_gates(folder, {})).front();
  };
  EXPECT_TRUE(proof("contact.k3_n_per_m3=3.1e8").holds());
  EXPECT_THAT(proof("tool.mass_kg=1.0").failure, HasSubstr("stays within"));
  // Of another unit: red, and no proof.
  std::string text = gate_text("1e-6", "contact.k3_n_per_m3=3.1e8");
  write("one.toml", text.replace(text.find("unit = \"N\""), 10, "unit = \"m\""));
  const GateFolder folder = loaded();
  EXPECT_THAT(prove_gates(folder, run_gates(folder, {})).front().failure, HasSubstr("without the change"));
  EXPECT_EQ(verb({.prove = true}), fast::answer_is_no);
}

TEST_F(GateFolderTest, MissingReferenceDataIsBadInput) {
  std::string text = gate_text("1.0", "contact.k3_n_per_m3=3.1e8");
  write("one.toml", text.insert(text.find("set ="), "reference = \"reference/none\"\n"));
  EXPECT_THAT([&] { (void)run_gates(loaded(), {}); },
              ThrowsMessage<scene::InputError>(
                  AllOf(HasSubstr("one.toml"), HasSubstr("there is no folder"), HasSubstr("--regenerate one"))));
}

TEST_F(GateFolderTest, AQuantityThatTheRunDoesNotHaveIsBadInput) {
  std::string text = gate_text("1.0", "contact.k3_n_per_m3=3.1e8");
  write("one.toml", text.replace(text.find("force.peak_fast_n"), 17, "force.peek_fast_n"));
  EXPECT_THAT([&] { (void)run_gates(loaded(), {}); },
              ThrowsMessage<scene::InputError>(AllOf(HasSubstr("one.toml:"), HasSubstr("no figure force.peek_fast_n"),
                                                     HasSubstr("did you mean \"force.peak_fast_n\"?"))));
}

TEST_F(GateFolderTest, HoldsAModelThatNobodyHereKnows) {
  std::string text = gate_text("1e-6", "contact.k1_n_per_m=41.0");
  write("one.toml", text.insert(text.find("set ="), "model = \"spring\"\n"));
  const GateFolder folder = load_gates(this->folder(), {testing::springs});
  const GateRecord record = run_gates(folder, {}).front();
  EXPECT_NEAR(*record.value, 40.0 * 0.005, 1e-9) << "k1 at the deepest instant";
  (void)accept(folder, {record});
  const GateFolder accepted = load_gates(this->folder(), {testing::springs});
  const std::vector<GateRecord> records = run_gates(accepted, {});
  EXPECT_TRUE(records.front().passes());
  EXPECT_TRUE(prove_gates(accepted, records).front().holds());
  write("one.toml", text.replace(text.find("\"spring\""), 8, "\"broken\""));
  EXPECT_THAT(run_gates(load_gates(this->folder(), {testing::springs}), {}).front().failure, HasSubstr("it broke"));
  write("one.toml", text.replace(text.find("\"broken\""), 8, "\"compliance-7\""));
  EXPECT_THAT(refusal(), HasSubstr("no model has the key \"compliance-7\""));
}

TEST_F(GateFolderTest, WhatNoGateAsksForIsAFault) {
  accept_all();
  EXPECT_THAT(loaded().unused, IsEmpty());
  write("reference/left-over/curve.csv", "");
  write("reference/accepted.json", R"({"one.gone": {"value": 1.0, "unit": "N", "scene_hash": ""}})");
  EXPECT_THAT(loaded().unused, SizeIs(2));
  EXPECT_THAT(loaded().unused, Contains(HasSubstr("left-over")));
  EXPECT_THAT(loaded().unused, Contains(HasSubstr("one.gone")));
  std::filesystem::remove_all(folder() / "reference/left-over");
  accept_all();
  EXPECT_THAT(loaded().unused, IsEmpty());
}

TEST_F(GateFolderTest, BadScenesAndChangesAreRefusedBeforeAnyWork) {
  write("one.toml", gate_text("1.0", "contact.k3_n_per_m=1"));
  write("two.toml", gate_text("1.0", "body.material.poissons_ratio=0.7"));
  EXPECT_THAT(refusal(), HasSubstr("(gate one.peak, red)"));
  EXPECT_THAT(refusal(), HasSubstr("(gate two.peak, red)"));
  std::filesystem::remove_all(folder());
  EXPECT_THAT(refusal(), HasSubstr("no gate files"));
}

TEST_F(GateFolderTest, AWiderLimitThanTheBaseNeedsAWaiverThatHolds) {
  commit();
  const auto today = std::chrono::year_month_day(2026y / 11 / 22);
  const BaseGates base = base_gates(folder(), "HEAD");
  ASSERT_THAT(base.files, SizeIs(1));
  const auto held = [&](std::chrono::year_month_day day) {
    const GateFolder now = loaded();
    std::vector<GateRecord> records{{"one", now.files.front().gates.front(), 0.0, {}, 0.0, ""}};
    const std::vector<std::string> faults = hold_limits(now, &base, day, records);
    return faults.empty() ? records.front().failure : faults.front();
  };
  write("one.toml", gate_text("1e-7", "contact.k3_n_per_m3=3.1e8"));
  EXPECT_EQ(held(today), "");
  write("one.toml", gate_text("2e-6", "contact.k3_n_per_m3=3.1e8"));
  EXPECT_THAT(held(today), HasSubstr("wider"));
  write("waivers.toml", "[[waiver]]\ngate = \"one.peak\"\nname = \"A\"\nreason = \"r\"\nuntil = 2026-11-23\n");
  EXPECT_EQ(held(today), "");
  EXPECT_EQ(held(2026y / 11 / 23), "");
  EXPECT_THAT(held(2026y / 11 / 24), HasSubstr("held until 2026-11-23"));
  write("waivers.toml", "[[waiver]]\ngate = \"one.pek\"\nname = \"A\"\nreason = \"r\"\nuntil = 2026-11-23\n");
  EXPECT_THAT(held(today), HasSubstr("for no gate"));
  std::filesystem::remove(folder() / "waivers.toml");
  std::string text = gate_text("1e-6", "contact.k3_n_per_m3=3.1e8");
  write("one.toml", text.replace(text.find("force.peak_fast_n"), 17, "fast.regions_max"));
  EXPECT_THAT(held(today), HasSubstr("quantity"));
  text = gate_text("1e-6", "contact.k3_n_per_m3=3.1e8");
  write("one.toml", text.insert(text.find("set ="), "model = \"compliance-1\"\n"));
  EXPECT_THAT(held(today), HasSubstr("model \"compliance-1\" instead of \"\""));
}

TEST_F(GateFolderTest, AGateOfTheBaseMayNotGoUnlessWaived) {
  write("two.toml", gate_text("1.0", "contact.k3_n_per_m3=3.1e8"));
  commit();
  std::filesystem::remove(folder() / "two.toml");
  const BaseGates base = base_gates(folder(), "HEAD");
  std::vector<GateRecord> none;
  EXPECT_THAT(hold_limits(loaded(), &base, 2026y / 11 / 22, none), Contains(HasSubstr("two.peak of HEAD is gone")));
  write("waivers.toml",
        "[[waiver]]\ngate = \"two.peak\"\nname = \"A\"\nreason = \"r\"\nuntil = 2026-11-23\nremoved = true\n");
  EXPECT_THAT(hold_limits(loaded(), &base, 2026y / 11 / 22, none), IsEmpty());
  EXPECT_THROW((void)base_gates(folder(), "no-such-branch"), scene::InputError);
}

TEST(GateReport, SaysWhyAndCounts) {
  const GateRecord good = judge("f", truth(0.05), error_of(0.02, 0.01), nullptr, "");
  const GateRecord bad = judge("f&<", truth(0.02), error_of(0.02, 0.01), nullptr, "");
  const GateRecord missing = judge("h", truth(0.02), {}, nullptr, "");
  const std::vector<GateRecord> records{good, bad, missing};
  const std::string junit = gates_junit(records, {"left <over>"});
  EXPECT_TRUE(testing::is_well_formed(junit)) << junit;
  EXPECT_THAT(junit, HasSubstr("tests=\"4\" failures=\"3\""));
  EXPECT_THAT(junit, HasSubstr("name=\"limit\" value=\"0.05\""));
  EXPECT_THAT(junit, HasSubstr("left &lt;over&gt;"));
  const std::string text = gates_text(records, {});
  EXPECT_THAT(text, HasSubstr("2 of 3 gates are red"));
  EXPECT_THAT(text, HasSubstr("there is no figure force.nrmse"));
  EXPECT_THAT(text, HasSubstr("40 %"));
  for (const scene::Figure& figure : gate_report_figures(records, {})) {
    if (figure.key == "gate.red") {
      EXPECT_EQ(figure.number, 2.0);
    }
  }
}

}  // namespace
}  // namespace touchstone::compare
