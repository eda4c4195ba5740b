// Gate files: what they mean, and what is said about bad ones.
#include "scene/gate_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace touchstone::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string head = "title = \"t\"\nrun = \"fast\"\nscene = \"../scenes/a.toml\"\n";
const std::string gate =
    "[[gate]]\nname = \"force\"\nkind = \"truth\"\nquantity = \"force.nrmse\"\nlimit = 0.02\nunit = \"\"\n"
    "reason = \"because\"\nred = [\"contact.k1_n_per_m=1\"]\n";

std::string without(std::string text, const std::string& part) { return text.erase(text.find(part), part.size()); }

std::string refusal(const std::string& text) {
  try {
    (void)parse_gate_file(text, "gates/a.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(GateFile, MeansWhatItSays) {
  const GateFile file =
      parse_gate_file(head + "set = [\"a=1\", \"b=2\"]\nreference = \"reference/a\"\n" + gate, "gates/a.toml");
  EXPECT_EQ(file.name, "a");
  EXPECT_EQ(file.run, GateRun::fast);
  EXPECT_EQ(file.scene_file, "scenes/a.toml");
  EXPECT_EQ(file.reference, "gates/reference/a");
  EXPECT_THAT(file.set, ElementsAre("a=1", "b=2"));
  ASSERT_EQ(file.gates.size(), 1u);
  EXPECT_EQ(file.gates[0].kind, GateKind::truth);
  EXPECT_EQ(file.gates[0].limit, 0.02);
  EXPECT_EQ(file.gates[0].place.line, 10);
  EXPECT_THAT(file.gates[0].red, ElementsAre("contact.k1_n_per_m=1"));
}

TEST(GateFile, ASecondCodeNeedsNoCommittedData) {
  const std::string both = "title = \"t\"\nrun = \"second_code\"\nscene = \"a.toml\"\n";
  EXPECT_EQ(parse_gate_file(both + gate, "gates/a.toml").run, GateRun::second_code);
  EXPECT_THAT(refusal(both + "reference = \"reference/a\"\n" + gate), HasSubstr("reference is never looked at"));
}

TEST(GateFile, EveryFaultIsToldAtOnceWithItsLine) {
  const std::string told = refusal(
      "title = \"t\"\nrun = \"compare\"\nscene = 3\n[[gate]]\nname = \"g\"\nkind = \"truth\"\nquantty = \"x\"\n"
      "limit = -1\nunit = \"\"\nreason = \"\"\nred = []\n");
  EXPECT_THAT(told, HasSubstr("gates/a.toml:2:"));
  EXPECT_THAT(told, HasSubstr("run = \"compare\"; expected \"fast\" or \"reference\" or \"second_code\""));
  EXPECT_THAT(told, HasSubstr("gates/a.toml:3:"));
  EXPECT_THAT(told, HasSubstr("gates/a.toml:7:1: unknown key \"gate.quantty\"; did you mean \"gate.quantity\"?"));
  EXPECT_THAT(told, HasSubstr("gates/a.toml:8:9: gate.limit: expected a number above 0"));
  EXPECT_THAT(told, HasSubstr("gate.reason: expected a text"));
  EXPECT_THAT(told, HasSubstr("gates/a.toml:11:7: gate.red"));
}

TEST(GateFile, NoPartOfAGateMayBeLeftOut) {
  EXPECT_EQ(refusal(head + gate), "accepted");
  for (const char* part : {"name = \"force\"\n", "kind = \"truth\"\n", "quantity = \"force.nrmse\"\n", "limit = 0.02\n",
                           "unit = \"\"\n", "reason = \"because\"\n", "red = [\"contact.k1_n_per_m=1\"]\n"}) {
    EXPECT_THAT(refusal(head + without(gate, part)), HasSubstr("expected")) << part;
  }
  for (const char* limit : {"nan", "inf", "0.0", "\"0.02\""}) {
    std::string text = head + gate;
    EXPECT_THAT(refusal(text.replace(text.find("0.02"), 4, limit)), HasSubstr("gate.limit")) << limit;
  }
  EXPECT_THAT(refusal(head), HasSubstr("no gate"));
  EXPECT_THAT(refusal(head + gate + gate), HasSubstr("\"force\" twice"));
}

TEST(GateFile, WaiversNeedANameAReasonAndADate) {
  const auto file = std::filesystem::temp_directory_path() / ("waivers-" + std::to_string(::getpid()) + ".toml");
  EXPECT_TRUE(load_gate_waivers(file).empty());
  const std::string waiver =
      "[[waiver]]\ngate = \"a.force\"\nname = \"A. Person\"\nreason = \"new law\"\nuntil = 2026-12-31\n";
  std::ofstream(file) << waiver;
  const std::vector<GateWaiver> waivers = load_gate_waivers(file);
  ASSERT_EQ(waivers.size(), 1u);
  EXPECT_EQ(waivers[0].gate, "a.force");
  EXPECT_EQ(waivers[0].until, std::chrono::year(2026) / 12 / 31);
  EXPECT_FALSE(waivers[0].removed);
  for (const char* part :
       {"gate = \"a.force\"\n", "name = \"A. Person\"\n", "reason = \"new law\"\n", "until = 2026-12-31\n"}) {
    std::ofstream(file) << without(waiver, part);
    EXPECT_THROW((void)load_gate_waivers(file), InputError) << part;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace touchstone::scene
