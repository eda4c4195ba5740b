#include "fast/bench/peer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::bench {
namespace {

PeerResult peer(const std::string& name, double step_us) {
  PeerResult result;
  result.size = "1k";
  result.setting.name = name;
  result.ticks = 10;
  result.sound = result.touching = true;
  result.step.cpu_us = step_us;
  result.step.wall.p50_us = 3.0 * step_us;  // other processes took time in between
  result.our_step_us = 10.0;
  return result;
}

TEST(Peer, TheFastestOfAMaterialThatDidItsWorkIsQuoted) {
  std::vector<PeerResult> peers = {peer("rubber.implicit", 900.0), peer("rubber.explicit", 600.0),
                                   peer("pvc.explicit", 100.0)};
  EXPECT_EQ(fastest(peers, "1k", "rubber")->step.cpu_us, 600.0);
  EXPECT_EQ(fastest(peers, "1k", "")->step.cpu_us, 100.0);
  EXPECT_EQ(fastest(peers, "4k", "rubber"), nullptr);
  EXPECT_EQ(fastest(peers, "1k", "rubber")->over_step(), 60.0);

  peers[1].touching = false;
  EXPECT_EQ(fastest(peers, "1k", "rubber")->step.cpu_us, 900.0);
  EXPECT_TRUE(std::isnan(peers[1].over_step())) << "no ratio to a body that the ball went through";
  peers[0].sound = false;
  EXPECT_EQ(fastest(peers, "1k", "rubber"), nullptr);
  EXPECT_TRUE(std::isnan(peers[0].over_step()));
  peers[2].ticks = 0;
  EXPECT_EQ(fastest(peers, "1k", ""), nullptr);
}

}  // namespace
}  // namespace touchstone::bench
