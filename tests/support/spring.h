// A contact model for the tests: a spring, on a body that does not deform.
#pragma once

#include "compare/model/request.h"

#include <fmt/format.h>

#include <memory>
#include <vector>

namespace touchstone::compare::testing {

class Spring final : public ContactModel {
 public:
  explicit Spring(double n_per_m) : n_per_m_(n_per_m) {}

  void step(const scene::Pose&) override { ++steps_; }
  void answer(scene::Answer& asked) override {
    for (scene::InstantRecord& instant : asked.instants) {
      if (instant.depth_m <= 0.0) continue;
      instant.regions.push_back({.depth_m = instant.depth_m, .force_n = {0.0, 0.0, n_per_m_ * instant.depth_m}});
    }
  }
  [[nodiscard]] int size() const override { return 1; }
  [[nodiscard]] std::string note() const override { return "one spring"; }

 private:
  double n_per_m_;
  int steps_ = 0;
};

/// One spring with the scene's k1, and one that cannot be set up.
[[nodiscard]] inline std::vector<ModelEntry> springs(const ModelRequest&) {
  return {
      {.name = "spring",
       .key = "spring",
       .label = "spring",
       .set_up = [](const scene::Scene& scene) { return std::make_unique<Spring>(scene.contact.k1_n_per_m); },
       .account = {.name = "one spring",
                   .far_shape = ", and a spring is nowhere else",
                   .parts = {{"whole", [](const scene::Scene& scene) { return scene; }}},
                   .parts_sentence = "{0} with the spring",
                   .cause = [](const scene::Scene&,
                               const Errors&) { return Reason{.about = "Likely cause", .brief = "It is a spring."}; },
                   .advise =
                       [](Advice& advice) {
                         const double twice_n_per_m = 2.0 * advice.scene().contact.k1_n_per_m;
                         advice.again("Take another spring.",
                                      fmt::format(" --set contact.k1_n_per_m={:.1f}", twice_n_per_m));
                       }}},
      {.name = "broken spring", .key = "broken", .set_up = [](const scene::Scene&) -> std::unique_ptr<ContactModel> {
         throw Unavailable("it broke");
       }}};
}

}  // namespace touchstone::compare::testing
