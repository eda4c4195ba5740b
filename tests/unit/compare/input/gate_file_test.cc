// Gate files: their meaning, and the messages about faulty ones.
#include "compare/input/gate_file.h"
#include "support/source_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <map>
#include <sstream>

namespace touchstone::compare {
namespace {

using namespace scene;
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
  EXPECT_THAT(refusal(both + "model = \"compliance-1\"\n" + gate), HasSubstr("model is for run = \"fast\" only"));
  EXPECT_THAT(refusal(both + "reference = \"reference/a\"\n" + gate), HasSubstr("reference is not used"));
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

/// A line that gives a key a good value, and one that gives it a value of another type.
struct Given {
  const char *good, *bad;
};

/// Checks that the table's defaults agree with the reader, and that a value of another type is refused.
void expect_told_truly(const std::vector<GateKey>& keys, const std::map<std::string, Given>& given,
                       const std::function<std::string(const std::string&)>& refusal_of) {
  std::string all;
  for (const GateKey& key : keys) {
    ASSERT_TRUE(given.contains(key.key)) << "no value to try for the new key " << key.key;
    all += std::string(given.at(key.key).good) + "\n";
  }
  EXPECT_EQ(given.size(), keys.size()) << "a key is gone";
  EXPECT_EQ(refusal_of(all), "accepted");
  for (const GateKey& key : keys) {
    const Given& line = given.at(key.key);
    const std::string good = std::string(line.good) + "\n";
    const bool required = key.default_value.empty();
    EXPECT_EQ(refusal_of(without(all, good)) == "accepted", !required) << key.key;
    EXPECT_THAT(refusal_of(without(all, good) + line.bad + "\n"), HasSubstr(key.key)) << key.key;
    EXPECT_FALSE(key.meaning.empty()) << key.key;
  }
}

TEST(GateReference, TellsWhatTheReaderTakes) {
  expect_told_truly(gate_file_keys(),
                    {{"title", {"title = \"t\"", "title = 1"}},
                     {"run", {"run = \"fast\"", "run = \"compare\""}},
                     {"model", {"model = \"compliance-1\"", "model = 1"}},
                     {"scene", {"scene = \"a.toml\"", "scene = 1"}},
                     {"set", {"set = [\"a=1\"]", "set = \"a=1\""}},
                     {"reference", {"reference = \"reference/a\"", "reference = true"}}},
                    [](const std::string& top) { return refusal(top + gate); });
  expect_told_truly(gate_keys(),
                    {{"name", {"name = \"force\"", "name = 1"}},
                     {"kind", {"kind = \"truth\"", "kind = \"lie\""}},
                     {"quantity", {"quantity = \"force.nrmse\"", "quantity = 1"}},
                     {"limit", {"limit = 0.02", "limit = 0"}},
                     {"unit", {"unit = \"\"", "unit = 1"}},
                     {"reason", {"reason = \"because\"", "reason = 1"}},
                     {"red", {"red = [\"a=1\"]", "red = []"}}},
                    [](const std::string& row) { return refusal(head + "[[gate]]\n" + row); });
  const auto file = std::filesystem::temp_directory_path() / ("waiver-keys-" + std::to_string(::getpid()) + ".toml");
  expect_told_truly(waiver_keys(),
                    {{"gate", {"gate = \"a.force\"", "gate = 1"}},
                     {"name", {"name = \"A. Person\"", "name = 1"}},
                     {"reason", {"reason = \"new law\"", "reason = 1"}},
                     {"until", {"until = 2026-12-31", "until = \"2026-12-31\""}},
                     {"removed", {"removed = true", "removed = 1"}}},
                    [&](const std::string& row) -> std::string {
                      std::ofstream(file) << "[[waiver]]\n" << row;
                      try {
                        (void)load_gate_waivers(file);
                      } catch (const InputError& error) {
                        return error.what();
                      }
                      return "accepted";
                    });
  std::filesystem::remove(file);
}

TEST(GateReference, NamesEveryWordOfAChoice) {
  for (const GateKey& key : gate_file_keys()) {
    if (key.key != "run") continue;
    for (const GateRun run : {GateRun::fast, GateRun::reference, GateRun::second_code})
      EXPECT_THAT(key.value, HasSubstr("\"" + std::string(name_of(run)) + "\""));
  }
  for (const GateKey& key : gate_keys()) {
    if (key.key != "kind") continue;
    for (const GateKind kind : {GateKind::truth, GateKind::drift})
      EXPECT_THAT(key.value, HasSubstr("\"" + std::string(name_of(kind)) + "\""));
  }
}

TEST(GateReference, IsWhatTheReportsShow) {
  std::ifstream in(source_folder() + "/reports/gate-reference.md");
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str(), gate_reference_markdown())
      << "reports/gate-reference.md is not the tables of gate_file.cc; rewrite it with: touchstone gate --keys";
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
}  // namespace touchstone::compare
