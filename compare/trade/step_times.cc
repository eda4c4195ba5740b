#include "compare/trade/step_times.h"

#include "compare/errors/reference_quality.h"
#include "fast/run/ticks.h"
#include "scene/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

namespace touchstone::compare {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

}  // namespace

Poses::Poses(const scene::Scene& scene) {
  const auto body = scene::body_shape(scene.body);
  fast::Ticks ticks(scene);
  if (ticks.count() > ticks_max) {
    throw scene::InputError(
        fmt::format("the track takes {} ticks at fast.rate_hz = {} Hz, and every model steps there and back: expected "
                    "at most {}",
                    ticks.count(), scene.fast.rate_hz, ticks_max));
  }
  while (const std::optional<fast::Tick> tick = ticks.next()) {
    const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
    if (scene::rest_depth_m(*body, scene.tool, pose) > grazing_depth_m) poses_.push_back(pose);
  }
  if (poses_.empty()) throw scene::InputError("the tool never touches the body on this track: nothing to trade");
}

void measure_by_turns(std::vector<Timed>& models, const Poses& poses, std::size_t rounds) {
  constexpr std::size_t warming_steps = 2;
  constexpr double slow_us = 2000.0;
  for (Timed& model : models) {
    const Clock::time_point begin = Clock::now();
    model.model->step(poses.at(model.next++));
    model.model->step(poses.at(model.next++));
    if (0.5e6 * seconds_since(begin) > slow_us) model.block = 2;
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    for (Timed& model : models) {
      const std::size_t steps = std::max(warming_steps + model.block, poses.round_trip() / rounds + 1);
      for (std::size_t k = model.block; k < steps; ++k) model.model->step(poses.at(model.next++));
      for (std::size_t k = 0; k < model.block; ++k) {
        const scene::Pose& pose = poses.at(model.next++);
        const Clock::time_point begin = Clock::now();
        model.model->step(pose);
        model.step_us.push_back(1e6 * seconds_since(begin));
      }
    }
  }
}

}  // namespace touchstone::compare
