// The page of a live run: numbers first, a sentence for every fault, a histogram per duration.
#include "compare/report/live_report.h"

#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

scene::Scene ball() {
  scene::Scene scene = testing::ball_on_cube(2, 300);
  scene.title = "A ball & a cube";
  scene.live = {4.0, 500.0, 0.05, 0.1, 2.0, 300.0};
  return scene;
}

/// 2000 ticks at 1 kHz, a force that rises to 3 N at 1 s and falls again; a lateness of 40 us, once 0.9 ms. The ledger
/// has percentiles to 1 % and exact maxima.
live::LiveResult two_seconds() {
  live::LiveResult result;
  result.rate_hz = 1000;
  result.planned_s = 2.0;
  live::Ledger& ledger = result.ledger;
  for (int i = 0; i < 2000; ++i) {
    live::TickRecord record;
    record.sequence = record.tick.index = i;
    record.model.force_n.z() = record.published.force_n.z() = 3.0 * std::max(0.0, 1.0 - std::abs(i - 1000) / 500.0);
    result.history.add(record);
    ledger.lateness.add(i == 1500 ? 900'000 : 40'000);
    ledger.step.add(i == 700 ? 420'000 : 110'000);
    ledger.force.add(60'000);
    ledger.shape.add(50'000);
    ledger.stages[0].add(20'000);
    if (i > 500 && i < 1500) ledger.stages[2].add(9'000);
  }
  ledger.ticks = 2000;
  ledger.force_max_n = ledger.model_force_max_n = 3.0;
  return result;
}

std::string html(const live::LiveResult& result, const live::LiveOptions& options = {}) {
  scene::Manifest manifest;
  manifest.command = "touchstone live";
  manifest.entries.emplace_back("command_line", "touchstone live ball.toml --device hand");
  manifest.resolved_scene = "[body]";
  std::string page = live_report_html(ball(), options, result, manifest);
  EXPECT_TRUE(testing::is_well_formed(page));
  EXPECT_FALSE(testing::shows_not_a_number(page));
  return page;
}

TEST(LiveReport, BeginsWithTheNumbers) {
  const std::string page = html(two_seconds());
  const std::string first = page.substr(0, page.find("<nav>"));
  EXPECT_THAT(first, HasSubstr("<h1>A ball &amp; a cube</h1>"));
  EXPECT_THAT(first, HasSubstr("<span>Ticks done</span><b>2000</b><span>of 2000 due, 1000 a second</span>"));
  EXPECT_THAT(first, HasSubstr("<span>Ticks missed</span><b>0</b>"));
  EXPECT_THAT(first, HasSubstr("<span>Lateness, median</span><b>40.2\u00a0µs</b>"
                               "<span>99.9\u00a0% within 40.2\u00a0µs, longest 900\u00a0µs</span>"));
  EXPECT_THAT(first, HasSubstr("<b>420\u00a0µs</b><span>median 110\u00a0µs; the period is 1\u00a0ms</span>"));
  EXPECT_THAT(first, HasSubstr("<b>3\u00a0N</b><span>at 1\u00a0s; limit 4\u00a0N</span>"));
  EXPECT_THAT(first, HasSubstr("<p class=\"lead\">Every tick was done.</p>"));
  EXPECT_THAT(first, HasSubstr("<title>Force over time</title>"));
  EXPECT_THAT(first, HasSubstr("<title>Lateness of the loop</title>"));
}

TEST(LiveReport, TheForceIsDrawnOverTimeWithItsLimit) {
  live::LiveResult result = two_seconds();
  std::string page = html(result);
  EXPECT_THAT(page, HasSubstr("Each point is the largest of 4\u00a0ticks (4\u00a0ms)."));
  EXPECT_THAT(page, HasSubstr("<title>sent to the device | time [s]: 1.002; force [N]: 3</title>"));
  EXPECT_THAT(page, HasSubstr(">limit</text>"));
  EXPECT_THAT(page, Not(HasSubstr(">of the model</text>")));
  // Where a limit applied, the model's force is drawn, too.
  live::TickRecord record;
  record.sequence = record.tick.index = 2000;
  record.model.force_n.z() = 9.0;
  record.published.force_n.z() = 4.0;
  result.history.add(record);
  result.ledger.limited_ticks = 1;
  result.ledger.model_force_max_n = 9.0;
  page = html(result);
  EXPECT_THAT(page, HasSubstr(">of the model</text>"));
  EXPECT_THAT(page, HasSubstr("In 1\u00a0tick a safety limit changed the model's force before it was sent."));
  EXPECT_THAT(page, HasSubstr("the force sent is not the model's, whose largest is 9\u00a0N"));
}

TEST(LiveReport, TheColumnsOfAHistogramHoldEveryTick) {
  const std::string page = html(two_seconds());
  const std::string plot = page.substr(page.find("<title>Lateness of the loop</title>"), 6000);
  EXPECT_THAT(plot, HasSubstr("<title>lateness [µs]: 39.8 to 50.1; ticks: 1999</title>"));
  EXPECT_THAT(plot, HasSubstr("<title>lateness [µs]: 794 to 1000; ticks: 1</title>"));
}

TEST(LiveReport, ShowsTheTickAndEachStageThatRan) {
  const std::string page = html(two_seconds());
  EXPECT_THAT(page, HasSubstr("<title>The whole tick</title>"));
  EXPECT_THAT(page, HasSubstr("<title>From pose to force</title>"));
  EXPECT_THAT(page, HasSubstr("<title>detection</title>"));
  EXPECT_THAT(page, HasSubstr("Of the 999\u00a0ticks in which it ran."));
  EXPECT_THAT(page, Not(HasSubstr("<title>friction</title>")));
  EXPECT_THAT(page, HasSubstr("<td>stage force</td><td class=\"n\">9\u00a0µs</td>"));
  EXPECT_THAT(page, Not(HasSubstr("stage friction")));
}

TEST(LiveReport, CountsMissedTicksAndDrawsWhen) {
  live::LiveResult result = two_seconds();
  EXPECT_THAT(html(result), Not(HasSubstr("Missed ticks over time")));
  live::TickRecord record;
  record.sequence = 2000;
  record.tick.index = 2007;
  result.history.add(record);
  result.ledger.missed = 10;  // three of them after the last tick
  result.ledger.ticks = 2001;
  result.ledger.lateness.add(7'200'000);
  const std::string page = html(result);
  EXPECT_THAT(page, HasSubstr("10 of 2011 ticks were missed: the loop reached them more than a period late"));
  EXPECT_THAT(page, HasSubstr("<b>10</b><span>0.497\u00a0% of those due</span>"));
  EXPECT_THAT(page, HasSubstr("<title>Missed ticks over time</title>"));
  EXPECT_THAT(page, HasSubstr("ticks missed: 7</title>"));
  EXPECT_THAT(page, HasSubstr("3 more after the last tick done."));
  EXPECT_THAT(page, HasSubstr(">more than a period</text>"));
}

TEST(LiveReport, SaysFaultsInWords) {
  live::LiveResult result = two_seconds();
  std::string page = html(result);
  EXPECT_THAT(page, HasSubstr("<th>model</th><td>nothing to report</td>"));
  EXPECT_THAT(page, HasSubstr("<th>poses</th><td>all usable</td>"));
  EXPECT_THAT(page, HasSubstr("<th>force limits</th><td>never reached</td>"));
  EXPECT_THAT(page, HasSubstr("<th>end</th><td>as planned</td>"));
  result.ledger.status = static_cast<std::uint32_t>(fast::StepStatus::law_saturated);
  result.ledger.bad_poses = 12;
  result.dropped_records = 5;
  result.interrupted = true;
  result.scheduling.warnings = {"SCHED_FIFO refused (Operation not permitted): <ask>"};
  result.replay = live::ReplayAnswer{2000, 2000, 3, 41};
  page = html(result);
  EXPECT_THAT(
      page,
      HasSubstr("The model reported: the depth exceeded the peak of the contact law, and the peak force was kept."));
  EXPECT_THAT(page, HasSubstr("In 12\u00a0ticks the device gave no usable pose"));
  EXPECT_THAT(page, HasSubstr("live.csv lacks 5\u00a0ticks"));
  EXPECT_THAT(page, HasSubstr("ended early by a signal (Ctrl-C)"));
  EXPECT_THAT(page, HasSubstr("(Operation not permitted): &lt;ask&gt;"));
  EXPECT_THAT(page, HasSubstr("3 of 2000\u00a0answers differ from the log's, the first on line 43 of the log"));
}

TEST(LiveReport, NoTwoPartsHaveOneName) {
  const std::string page = html(two_seconds());
  std::set<std::string> names;
  const std::regex name("<h2>([^<]*)</h2>");
  for (std::sregex_iterator at(page.begin(), page.end(), name), end; at != end; ++at) {
    EXPECT_TRUE(names.insert((*at)[1]).second) << (*at)[1];
  }
  EXPECT_GT(names.size(), 4u);
}

TEST(LiveReport, NamesDeviceRateLimitsAndCommand) {
  live::LiveOptions options;
  std::string page = html(two_seconds(), options);
  EXPECT_THAT(page, HasSubstr("scripted: the scene's track, followed exactly"));
  EXPECT_THAT(page, Not(HasSubstr("simulated hand")));
  options.device = live::DeviceKind::hand;
  page = html(two_seconds(), options);
  EXPECT_THAT(page, HasSubstr("mass 0.1\u00a0kg, damping 2\u00a0N s/m, stiffness 300\u00a0N/m"));
  EXPECT_THAT(page, HasSubstr("1000\u00a0Hz, a period of 1\u00a0ms"));
  EXPECT_THAT(page, HasSubstr("<th>fastest change of force</th><td>500\u00a0N/s</td>"));
  EXPECT_THAT(page, HasSubstr("falls to zero in 50\u00a0ms"));
  EXPECT_THAT(page, HasSubstr(">touchstone live ball.toml --device hand</td>"));
  options.device = live::DeviceKind::replay;
  options.log = "earlier/live.csv";
  EXPECT_THAT(html(two_seconds(), options), HasSubstr("<th>log played</th><td>earlier/live.csv</td>"));
}

TEST(LiveReport, ARunWithoutATickIsAPageAllTheSame) {
  live::LiveResult result;
  result.rate_hz = 1000;
  result.planned_s = 1.0;
  result.interrupted = true;
  const std::string page = html(result);
  EXPECT_THAT(page, HasSubstr("No tick was done."));
  EXPECT_THAT(page, HasSubstr("nothing to show"));
}

TEST(LiveReport, IsWrittenIntoTheFolder) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(write_live_report(folder.path(), ball(), {}, two_seconds(), {}), folder.path() / "report.html");
  std::stringstream text;
  text << std::ifstream(folder.path() / "report.html").rdbuf();
  EXPECT_TRUE(testing::is_well_formed(text.str()));
}

}  // namespace
}  // namespace touchstone::compare
