#include "scene/model/first_contact.h"
#include "scene/model/rest_depth.h"

#include <fmt/format.h>

#include <cmath>

namespace touchstone::scene {

std::string no_contact_warning(const Scene& scene) {
  if (scene.track.empty()) return "";
  const auto body = body_shape(scene.body);
  const RestDepth depth(*body, scene.tool);
  const std::vector<double> recorded_s = instants_s(scene);
  const auto touches = [&](const Pose& pose) { return depth.depth_m(pose) > 0.0; };
  for (const double time_s : recorded_s) {
    if (touches(pose_at(scene.track, time_s))) return "";
  }
  constexpr int samples = 200;
  const double begin_s = scene.track.front().time_s, end_s = scene.track.back().time_s;
  std::vector<double> times_s = recorded_s;
  for (const Waypoint& w : scene.track) times_s.push_back(w.time_s);
  for (int i = 0; i <= samples; ++i) times_s.push_back(begin_s + (end_s - begin_s) * i / samples);
  double least_m = INFINITY, least_s = begin_s;
  for (const double time_s : times_s) {
    const Pose pose = pose_at(scene.track, time_s);
    const double here_m = depth.gap_m(pose);
    if (here_m < 0.0 && touches(pose)) {
      return fmt::format(
          "the tool touches the body only between the {} recorded instants, at {:.4g} s among others; raise "
          "compare.instants",
          scene.compare.instants, time_s);
    }
    if (here_m < least_m) {
      least_m = here_m;
      least_s = time_s;
    }
  }
  return fmt::format(
      "the tool never touches the body on this track; the least gap is {:.4g} mm, at {:.4g} s, so every force is "
      "zero",
      1e3 * std::max(0.0, least_m), least_s);
}

}  // namespace touchstone::scene
