// Fig. 15: under the same force the mallet's head, with the larger contact area, goes less deep than its tail.
#include "experiments/experiment.h"
#include "experiments/round_contact.h"

#include <cmath>

namespace touchstone::test {
namespace {

using scene::InstantRecord;

double largest_displacement_m(const InstantRecord& instant) {
  return instant.displacement_m.colwise().norm().maxCoeff();
}

/// A quantity at the force F, linear between the instants.
template <class Quantity>
double at_force(const std::vector<InstantRecord>& instants, double force_n, Quantity quantity) {
  for (std::size_t k = 1; k < instants.size(); ++k) {
    const double low_n = instants[k - 1].force_n().z(), high_n = instants[k].force_n().z();
    if (force_n < low_n || force_n > high_n) continue;
    const double s = (force_n - low_n) / (high_n - low_n);
    return (1.0 - s) * quantity(instants[k - 1]) + s * quantity(instants[k]);
  }
  ADD_FAILURE() << "no instant has a force of " << force_n << " N";
  return 0.0;
}

class ContactArea : public Experiment {
 protected:
  const scene::Scene head_scene_ = scene("mallet-head-on-cube"), tail_scene_ = scene("mallet-tail-on-cube");
  const std::vector<InstantRecord> head_ = in_contact(head_scene_), tail_ = in_contact(tail_scene_);

  /// The head's face, flat up to 9 mm, with a fillet of 3 mm.
  [[nodiscard]] RoundContact head_contact(double depth_m) const {
    const double flat_m = 0.009, edge_m = 0.003;
    return {flat_m + std::sqrt(edge_m * edge_m - (edge_m - depth_m) * (edge_m - depth_m)), [=](double r_m) {
              const double out_m = std::max(0.0, r_m - flat_m);
              return depth_m - (edge_m - std::sqrt(edge_m * edge_m - out_m * out_m));
            }};
  }
  /// The tail's half ball of 4 mm.
  [[nodiscard]] RoundContact tail_contact(double depth_m) const { return ball_contact(0.004, depth_m); }
};

TEST_P(ContactArea, SameForceMakesTheHeadShallower) {
  const auto depth_m = [](const InstantRecord& instant) { return instant.depth_m; };
  for (const double part : {0.2, 0.5, 1.0}) {
    const double force_n = part * tail_.back().force_n().z();
    EXPECT_LT(at_force(head_, force_n, depth_m), 0.5 * at_force(tail_, force_n, depth_m)) << force_n;
    EXPECT_LT(at_force(head_, force_n, largest_displacement_m), 0.7 * at_force(tail_, force_n, largest_displacement_m))
        << force_n;
  }
  const double force_n = tail_.back().force_n().z();
  record("head_depth_mm", 1e3 * at_force(head_, force_n, depth_m));
  record("head_displacement_mm", 1e3 * at_force(head_, force_n, largest_displacement_m));
  record("tail_displacement_mm", 1e3 * largest_displacement_m(tail_.back()));
}

TEST_P(ContactArea, SameDepthMakesTheHeadsForceLarger) {
  for (const InstantRecord& tail : tail_) {
    const auto head =
        std::find_if(head_.begin(), head_.end(), [&](const auto& instant) { return instant.time_s == tail.time_s; });
    ASSERT_NE(head, head_.end());
    EXPECT_NEAR(head->depth_m, tail.depth_m, 2e-6);
    EXPECT_GT(head->regions[0].area_m2, 5.0 * tail.regions[0].area_m2) << tail.depth_m;
    EXPECT_GT(head->force_n().z(), 4.0 * tail.force_n().z()) << tail.depth_m;
  }
}

TEST_P(ContactArea, ForceIsThatOfTheContactsOwnRadius) {
  // k1 grows with the contact radius; the mean is taken over its depths. The mesh is slightly inside the half ball.
  for (const auto& [instant, contact] : {std::pair(head_.back(), head_contact(head_.back().depth_m)),
                                         std::pair(tail_.back(), tail_contact(tail_.back().depth_m))}) {
    const double k1_n_per_m = head_scene_.contact.k1_per_radius_n_per_m2 * contact.radius_m;
    const double expected_n = mean_force_n(
        GetParam(), [&](double d_i) { return k1_n_per_m * d_i; }, contact);
    EXPECT_NEAR(instant.force_n().z(), expected_n, 0.06 * expected_n);
  }
}

/// Balls of 10, 20 and 40 mm, 2 mm deep in the cube of ball-on-cube-press: the depths have the same distribution, the
/// area doubles.
std::vector<InstantRecord> growing_balls(const scene::Scene& press, const scene::Contact& contact) {
  std::vector<InstantRecord> out;
  for (const int times : {1, 2, 4}) {
    scene::Scene scene = press;
    scene.contact = contact;
    scene.tool.radius_m *= times;
    scene.fast.tool_samples *= times;  // the same number on the contact
    const double top_m = scene.body.size_m.z();
    scene.track.front().pose.position_m.z() = top_m + scene.tool.radius_m + 1e-4;
    scene.track.back().pose.position_m.z() = top_m + scene.tool.radius_m - 2e-3;
    out.push_back(fast::run(scene).instants.back());
  }
  return out;
}

TEST_P(ContactArea, PlainLawDoesNotSeeTheArea) {
  // Errata E7: the weights of appendix III sum to one, so that the force is a mean of the law over the region.
  const scene::Scene press = scene("ball-on-cube-press");
  const std::vector<InstantRecord> balls = growing_balls(press, press.contact);
  EXPECT_NEAR(balls[1].regions[0].area_m2, 2.0 * balls[0].regions[0].area_m2, 0.15 * balls[0].regions[0].area_m2);
  EXPECT_NEAR(balls[2].regions[0].area_m2, 4.0 * balls[0].regions[0].area_m2, 0.5 * balls[0].regions[0].area_m2);
  EXPECT_NEAR(balls[1].force_n().z(), balls[0].force_n().z(), 0.1 * balls[0].force_n().z());
  EXPECT_NEAR(balls[2].force_n().z(), balls[0].force_n().z(), 0.1 * balls[0].force_n().z());
  // The head's contact is 12 times the tail's, but neither reaches the law's force at its own depth.
  for (scene::Scene scene : {head_scene_, tail_scene_}) {
    scene.contact = press.contact;
    const InstantRecord last = in_contact(scene).back();
    const double D = last.depth_m;
    EXPECT_LT(last.force_n().z(), D * (press.contact.k1_n_per_m + press.contact.k3_n_per_m3 * D * D));
    record(scene.name, last.force_n().z());
  }
  record("ball_10_mm", balls[0].force_n().z());
  record("ball_40_mm", balls[2].force_n().z());
}

TEST_P(ContactArea, AreaAwareLawGrowsWithTheRadius) {
  const std::vector<InstantRecord> balls = growing_balls(scene("ball-on-cube-press"), head_scene_.contact);
  EXPECT_NEAR(balls[1].force_n().z() / balls[0].force_n().z(), std::sqrt(2.0), 0.1);
  EXPECT_NEAR(balls[2].force_n().z() / balls[0].force_n().z(), 2.0, 0.15);
  record("ball_10_mm", balls[0].force_n().z());
  record("ball_40_mm", balls[2].force_n().z());
}

INSTANTIATE_TEST_SUITE_P(Fig15, ContactArea, both_formulations, formulation_name);

}  // namespace
}  // namespace touchstone::test
