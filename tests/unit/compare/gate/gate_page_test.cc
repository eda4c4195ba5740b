// The page of gates: its first lines, and every gate with its numbers.
#include "compare/gate/gate_page.h"

#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

GateRecord truth(const std::string& name, double value, double uncertainty) {
  GateRecord record;
  record.file = "ball";
  record.gate = {name, GateKind::truth, "force.nrmse", 0.02, "", "because <this>", {"a=1"}, {}};
  record.value = value;
  record.uncertainty = uncertainty;
  return record;
}

GateFolder folder() {
  GateFolder out;
  out.folder = "/gates";
  GateFile& file = out.files.emplace_back();
  file.name = "ball";
  file.title = "A ball & a cube";
  file.scene_file = "/scenes/ball.toml";
  return out;
}

std::string html(const std::vector<GateRecord>& records, const std::vector<std::string>& faults = {},
                 const std::vector<GateProof>& proofs = {}) {
  scene::Manifest manifest;
  manifest.command = "touchstone gate";
  std::string page = gate_page_html(folder(), records, faults, proofs, manifest, "/out/gate");
  EXPECT_TRUE(testing::is_well_formed(page));
  EXPECT_FALSE(testing::shows_not_a_number(page));
  return page;
}

TEST(GatePage, SaysFirstWhetherAllHold) {
  EXPECT_THAT(html({truth("force", 0.01, 0.002)}), HasSubstr("The gate holds</h1>"));
  EXPECT_THAT(html({truth("force", 0.01, 0.002), truth("shape", 0.01, 0.002)}), HasSubstr("All 2 gates hold</h1>"));
  EXPECT_THAT(html({truth("force", 0.03, 0.002)}), HasSubstr("The gate is red</h1>"));
  const std::string red = html({truth("force", 0.01, 0.002), truth("shape", 0.03, 0.002)});
  EXPECT_THAT(red, HasSubstr("1 of 2 gates is red</h1>"));
  EXPECT_THAT(red, HasSubstr("|0.03| + 0.002 is beyond 0.02. The limit is there because: because &lt;this&gt;."));
  EXPECT_THAT(html({truth("force", 0.01, 0.002)}, {"accepted value x: no gate asks for it"}),
              HasSubstr("The gate holds, but the run failed: 1 fault</h1>"));
}

TEST(GatePage, ShowsValueUncertaintyLimitMarginAndBar) {
  const std::string page = html({truth("force", 0.01, 0.002)});
  EXPECT_THAT(page, HasSubstr("1\u00a0%, uncertain by 0.2\u00a0%; together at most 2\u00a0%"));
  EXPECT_THAT(page, HasSubstr("40\u00a0% of the limit left"));
  // The value is half of the way to the limit, the uncertainty a tenth.
  EXPECT_THAT(page, HasSubstr("<rect x=\"0\" y=\"2\" width=\"120.00\""));
  EXPECT_THAT(page, HasSubstr("<rect x=\"120.00\" y=\"2\" width=\"24.00\""));
  EXPECT_THAT(page, HasSubstr("href=\"../../gates/ball.toml\""));
  EXPECT_THAT(page, HasSubstr("href=\"../../scenes/ball.toml\""));
}

TEST(GatePage, RoundOffIsSaidAsSuch) {
  EXPECT_THAT(html({truth("force", 3e-15, 0.002)}), HasSubstr("below 0.0001\u00a0%, uncertain by 0.2\u00a0%"));
}

TEST(GatePage, AGateWithoutANumberHasNoBarAndSaysWhy) {
  GateRecord record = truth("force", 0.0, 0.0);
  record.value.reset();
  record.uncertainty.reset();
  record.failure = "there is no figure force.nrmse";
  const std::string page = html({record});
  EXPECT_THAT(page, HasSubstr("there is no figure force.nrmse"));
  EXPECT_THAT(page, HasSubstr("no number"));
  EXPECT_THAT(page, Not(HasSubstr("y=\"2\"")));
}

TEST(GatePage, TellsWhatEveryChangeDid) {
  GateProof held, missed;
  held.changed = truth("force", 0.05, 0.002);
  missed.changed = truth("shape", 0.01, 0.002);
  missed.failure = "it stays within its limit";
  const std::string page = html({truth("force", 0.01, 0.002), truth("shape", 0.01, 0.002)}, {}, {held, missed});
  EXPECT_THAT(page, HasSubstr("1 of 2"));
  EXPECT_THAT(page, HasSubstr("Proved: with it, 5\u00a0%"));
  EXPECT_THAT(page, HasSubstr("Not proved: it stays within its limit"));
}

}  // namespace
}  // namespace touchstone::compare
