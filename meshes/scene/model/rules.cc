#include "scene/model/rules.h"

#include "scene/model/rest_depth.h"
#include "scene/shape/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace touchstone::scene {
namespace {

/// The largest rest depth of the track [m]; between rows the track is sampled finely.
double deepest_m(const Scene& scene, const Shape& body) {
  constexpr int samples = 1000;
  const double begin_s = scene.track.front().time_s, end_s = scene.track.back().time_s;
  const RestDepth depth(body, scene.tool);
  double deepest = 0.0;
  for (const Waypoint& w : scene.track) deepest = std::max(deepest, depth.depth_m(w.pose));
  for (int i = 0; i <= samples; ++i) {
    const Pose pose = pose_at(scene.track, begin_s + (end_s - begin_s) * i / samples);
    deepest = std::max(deepest, depth.depth_m(pose));
  }
  return deepest;
}

/// Largest number of ticks of a track; more would take the fast model hours.
constexpr double ticks_max = 1e8;

void check_track(const Scene& scene, std::vector<Violation>& found) {
  if (scene.track.size() < 2) {
    found.push_back(
        {"track", fmt::format("a track needs at least two poses, expected 2 or more, found {}", scene.track.size())});
    return;
  }
  for (std::size_t i = 1; i < scene.track.size(); ++i) {
    const double before_s = scene.track[i - 1].time_s, now_s = scene.track[i].time_s;
    if (now_s <= before_s) {
      found.push_back({"track[" + std::to_string(i) + "].time_s",
                       fmt::format("time runs backwards: {:.4g} s after {:.4g} s; expected a time above {:.4g} s",
                                   now_s, before_s, before_s)});
    }
  }
  const double ticks = (scene.track.back().time_s - scene.track.front().time_s) * scene.fast.rate_hz;
  if (found.empty() && ticks > ticks_max) {
    found.push_back({"track", fmt::format("takes {:.4g} ticks at fast.rate_hz = {:.4g} Hz; expected at most {:.4g}",
                                          ticks, scene.fast.rate_hz, ticks_max)});
  }
}

/// Largest number of recorded triangles over all instants; more would take `fast` over ten seconds and 1 GiB.
constexpr double recorded_triangles_max = 1e7;

void check_records(const Scene& scene, std::vector<Violation>& found) {
  const double recorded = static_cast<double>(scene.fast.triangles) * scene.compare.instants;
  if (recorded <= recorded_triangles_max) return;
  found.push_back({"compare.instants",
                   fmt::format("{} records of {} triangles (fast.triangles); expected at most {} records of as many",
                               scene.compare.instants, scene.fast.triangles,
                               static_cast<int>(recorded_triangles_max) / scene.fast.triangles)});
}

void check_start(const Scene& scene, const Shape& body, std::vector<Violation>& found) {
  constexpr double round_off_m = 1e-9;  // of a track that starts where the tool just touches the body
  const double depth_m = rest_depth_m(body, scene.tool, scene.track.front().pose);
  if (depth_m > round_off_m) {
    found.push_back({"track[0].position_m",
                     fmt::format("the tool starts {:.4g} mm inside the body; expected a first pose with no overlap",
                                 depth_m * 1e3)});
  }
}

/// @param deepest_m  called only if needed
void check_contact_law(const Scene& scene, const std::function<double()>& deepest_m, std::vector<Violation>& found) {
  const Contact& c = scene.contact;
  const bool no_linear_term = (c.law == ContactLaw::duffing && c.k1_n_per_m == 0.0) ||
                              (c.law == ContactLaw::area_aware && c.k1_per_radius_n_per_m2 == 0.0);
  if (no_linear_term && c.k3_n_per_m3 <= 0.0) {
    found.push_back({"contact.k3_n_per_m3", "a law with k1 = 0 needs k3 > 0, or there is no force"});
  } else if (c.k3_n_per_m3 < 0.0 && c.law == ContactLaw::duffing) {
    // Errata E1: beyond D* = sqrt(k1 / (3 |k3|)) the softening law's force falls.
    const double peak_m = std::sqrt(c.k1_n_per_m / (-3.0 * c.k3_n_per_m3));
    const double deepest = deepest_m();
    if (deepest > peak_m) {
      found.push_back(
          {"contact.k3_n_per_m3",
           fmt::format(
               "the softening law peaks at {:.4g} mm but the track reaches {:.4g} mm; expected k3 >= {:.4g} N/m^3",
               peak_m * 1e3, deepest * 1e3, -c.k1_n_per_m / (3.0 * deepest * deepest))});
    }
  }
}

void check_local_factor(const Scene& scene, std::vector<Violation>& found) {
  // Errata E16: w_p(0) = 1 + C_n ln(C_r / (r_R + C_r)) must not be negative.
  const FastSettings& f = scene.fast;
  const double limit = 1.0 / std::log((f.r_R_m + f.C_r_m) / f.C_r_m);
  if (f.formulation == Formulation::corrected && f.C_n > limit) {
    found.push_back(
        {"fast.C_n",
         fmt::format(
             "the local factor turns negative at the contact; expected C_n <= {:.4g} with these r_R_m and C_r_m",
             limit)});
  }
}

void check_profile(const Solid& solid, const std::string& table, std::vector<Violation>& found) {
  if (solid.shape != BodyShape::revolution) return;
  for (const std::string& fault : profile_faults(solid.profile)) found.push_back({table + ".profile_rz_m", fault});
}

void check_support(const Body& body, const Shape& shape, std::vector<Violation>& found) {
  const double middle_m = 0.5 * shape.bounds().upper_m.z();
  if (!body.flat_bottom() && body.support_height_m >= middle_m) {
    found.push_back({"body.support_height_m",
                     fmt::format("expected less than the height of the body's middle, {:.4g} m", middle_m)});
  }
}

/// Points all over a solid's surface, dense enough for a check by sampling.
Eigen::Matrix3Xd surface_points_m(const Shape& shape) { return tessellate(shape, 2000).points_m; }

void check_inclusions(const Body& body, const Shape& shape, std::vector<Violation>& found) {
  // Before the loop over pairs, whose cost grows with their number.
  if (body.inclusions.size() > inclusions_max) {
    found.push_back({"body.inclusion[0]",
                     fmt::format("expected at most {} inclusions, found {}", inclusions_max, body.inclusions.size())});
    return;
  }
  std::vector<std::unique_ptr<const Shape>> inclusions;
  for (const Inclusion& inclusion : body.inclusions) {
    const std::string name = "body.inclusion[" + std::to_string(inclusions.size()) + "]";
    inclusions.push_back(solid_shape(inclusion, inclusion.center_m));
    const Eigen::Matrix3Xd points_m = surface_points_m(*inclusions.back());
    double outermost_m = -1e300;
    for (const auto& p_m : points_m.colwise()) outermost_m = std::max(outermost_m, shape.signed_distance_m(p_m));
    if (outermost_m >= 0.0) {
      found.push_back(
          {name + ".center_m",
           fmt::format("reaches {:.4g} mm beyond the body's surface; expected it strictly inside", outermost_m * 1e3)});
    }
    for (std::size_t other = 0; other + 1 < inclusions.size(); ++other) {
      double apart_m = 1e300;
      for (const auto& p_m : points_m.colwise()) apart_m = std::min(apart_m, inclusions[other]->signed_distance_m(p_m));
      const Eigen::Matrix3Xd others_m = surface_points_m(*inclusions[other]);
      for (const auto& p_m : others_m.colwise()) apart_m = std::min(apart_m, inclusions.back()->signed_distance_m(p_m));
      if (apart_m <= 0.0) {
        found.push_back(
            {name + ".center_m",
             fmt::format("overlaps body.inclusion[{}] by {:.4g} mm; expected them apart", other, -apart_m * 1e3)});
      }
    }
  }
}

void check_probes(const std::vector<Probe>& probes, const Shape& body, std::vector<Violation>& found) {
  if (probes.size() > probes_max) {
    found.push_back({"probe[0]", fmt::format("expected at most {} probes, found {}", probes_max, probes.size())});
    return;
  }
  const Bounds box = body.bounds();
  const double round_off_m = 1e-9 * (box.upper_m - box.lower_m).maxCoeff();
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const std::string name = "probe[" + std::to_string(i) + "]";
    const auto first =
        std::find_if(probes.begin(), probes.end(), [&](const Probe& p) { return p.name == probes[i].name; });
    if (first != probes.begin() + static_cast<std::ptrdiff_t>(i)) {
      found.push_back({name + ".name", fmt::format("\"{}\" is the name of probe[{}]; expected another one",
                                                   probes[i].name, first - probes.begin())});
    } else if (probes[i].name.find_first_of(",\"") != std::string::npos) {
      found.push_back({name + ".name", "expected a name without comma or quotation mark, for a table"});
    }
    const double outside_m = body.signed_distance_m(probes[i].position_m);
    if (outside_m <= round_off_m) continue;
    found.push_back(
        {name + ".position_m",
         fmt::format("is {:.4g} mm outside the body at rest; expected a point in it or on its surface: x in [{:.4g}, "
                     "{:.4g}], y in [{:.4g}, {:.4g}], z in [{:.4g}, {:.4g}] m",
                     outside_m * 1e3, box.lower_m.x(), box.upper_m.x(), box.lower_m.y(), box.upper_m.y(),
                     box.lower_m.z(), box.upper_m.z())});
  }
}

void check_tool(const Tool& tool, std::vector<Violation>& found) {
  if (tool.shape != ToolShape::cylinder) return;
  const double largest_m = std::min(tool.radius_m, 0.5 * tool.length_m);
  if (!(tool.length_m > 0.0)) {
    found.push_back({"tool.length_m", "a cylinder needs a length above 0"});
  } else if (tool.edge_radius_m > largest_m) {
    found.push_back(
        {"tool.edge_radius_m", fmt::format("the fillet does not fit; expected at most {:.4g} m", largest_m)});
  }
}

void check_friction(const Contact& contact, std::vector<Violation>& found) {
  // Errata E5: at beta = 1 the static limit stays below the dynamic friction at every normal force.
  if (contact.friction && contact.friction->beta == 1.0 && contact.friction->mu_D > contact.friction->K) {
    found.push_back(
        {"contact.friction.mu_D",
         fmt::format("with beta = 1 the dynamic friction would exceed the static limit; expected mu_D <= K = {:.4g}",
                     contact.friction->K)});
  }
}

}  // namespace

std::vector<Violation> broken_constants(const Scene& scene, double deepest_m) {
  std::vector<Violation> found;
  check_friction(scene.contact, found);
  check_local_factor(scene, found);
  check_contact_law(
      scene, [deepest_m] { return deepest_m; }, found);
  return found;
}

std::vector<Violation> broken_shapes(const Scene& scene) {
  std::vector<Violation> found;
  check_profile(scene.body, "body", found);
  for (std::size_t i = 0; i < scene.body.inclusions.size(); ++i)
    check_profile(scene.body.inclusions[i], "body.inclusion[" + std::to_string(i) + "]", found);
  check_tool(scene.tool, found);
  return found;
}

std::vector<Violation> broken_rules(const Scene& scene) {
  std::vector<Violation> found = broken_shapes(scene);
  check_friction(scene.contact, found);
  check_local_factor(scene, found);
  check_track(scene, found);
  check_records(scene, found);
  if (!found.empty()) return found;
  const auto body = body_shape(scene.body);
  check_support(scene.body, *body, found);
  check_inclusions(scene.body, *body, found);
  check_probes(scene.probes, *body, found);
  check_start(scene, *body, found);
  check_contact_law(
      scene, [&] { return deepest_m(scene, *body); }, found);
  return found;
}

}  // namespace touchstone::scene
