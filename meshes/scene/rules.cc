#include "scene/rules.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace touchstone::scene {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// The largest rest depth of the track [m]; between rows the track is sampled finely.
double deepest_m(const Scene& scene, const Shape& body) {
  constexpr int samples = 1000;
  const double begin_s = scene.track.front().time_s, end_s = scene.track.back().time_s;
  double deepest = 0.0;
  for (const Waypoint& w : scene.track) deepest = std::max(deepest, rest_depth_m(body, scene.tool, w.pose));
  for (int i = 0; i <= samples; ++i) {
    const Pose pose = pose_at(scene.track, begin_s + (end_s - begin_s) * i / samples);
    deepest = std::max(deepest, rest_depth_m(body, scene.tool, pose));
  }
  return deepest;
}

void check_track(const Scene& scene, std::vector<Violation>& found) {
  if (scene.track.size() < 2) {
    found.push_back(
        {"track", "a track needs at least two poses, expected 2 or more, found " + std::to_string(scene.track.size())});
    return;
  }
  for (std::size_t i = 1; i < scene.track.size(); ++i) {
    const double before_s = scene.track[i - 1].time_s, now_s = scene.track[i].time_s;
    if (now_s <= before_s) {
      found.push_back({"track[" + std::to_string(i) + "].time_s",
                       "time runs backwards: " + number(now_s) + " s after " + number(before_s) +
                           " s; expected a time above " + number(before_s) + " s"});
    }
  }
}

void check_start(const Scene& scene, const Shape& body, std::vector<Violation>& found) {
  const double depth_m = rest_depth_m(body, scene.tool, scene.track.front().pose);
  if (depth_m > 0.0) {
    found.push_back({"track[0].position_m", "the tool starts " + number(depth_m * 1e3) +
                                                " mm inside the body; expected a first pose with no overlap"});
  }
}

void check_contact_law(const Scene& scene, const Shape& body, std::vector<Violation>& found) {
  const Contact& c = scene.contact;
  if (c.k1_n_per_m == 0.0 && c.k3_n_per_m3 <= 0.0) {
    found.push_back({"contact.k3_n_per_m3", "a law with k1 = 0 needs k3 > 0, or there is no force"});
  } else if (c.k3_n_per_m3 < 0.0) {
    // Errata E1: beyond D* = sqrt(k1 / (3 |k3|)) the softening law's force falls.
    const double peak_m = std::sqrt(c.k1_n_per_m / (-3.0 * c.k3_n_per_m3));
    const double deepest = deepest_m(scene, body);
    if (deepest > peak_m) {
      found.push_back({"contact.k3_n_per_m3",
                       "the softening law peaks at " + number(peak_m * 1e3) + " mm but the track reaches " +
                           number(deepest * 1e3) +
                           " mm; expected k3 >= " + number(-c.k1_n_per_m / (3.0 * deepest * deepest)) + " N/m^3"});
    }
  }
}

void check_local_factor(const Scene& scene, std::vector<Violation>& found) {
  // Errata E16: w_p(0) = 1 + C_n ln(C_r / (r_R + C_r)) must not be negative.
  const FastSettings& f = scene.fast;
  const double limit = 1.0 / std::log((f.r_R_m + f.C_r_m) / f.C_r_m);
  if (f.formulation == Formulation::corrected && f.C_n > limit) {
    found.push_back({"fast.C_n", "the local factor turns negative at the contact; expected C_n <= " + number(limit) +
                                     " with these r_R_m and C_r_m"});
  }
}

}  // namespace

std::vector<Violation> broken_rules(const Scene& scene) {
  std::vector<Violation> found;
  const Body& b = scene.body;
  if (b.shape == BodyShape::sphere && b.support_height_m >= b.radius_m) {
    found.push_back({"body.support_height_m", "expected less than the body's radius, " + number(b.radius_m) + " m"});
  }
  check_local_factor(scene, found);
  check_track(scene, found);
  if (!found.empty()) return found;
  const auto body = body_shape(b);
  check_start(scene, *body, found);
  check_contact_law(scene, *body, found);
  return found;
}

}  // namespace touchstone::scene
