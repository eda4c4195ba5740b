// What the benchmark runs: bodies, tools and tracks, one per case.
#pragma once

#include "scene/model/scene.h"
#include "scene/response/response.h"

#include <cstdint>
#include <string>
#include <vector>

namespace touchstone::bench {

/// One line of the benchmark.
struct Case {
  scene::BodyShape body = scene::BodyShape::box;  ///< box or ellipsoid
  std::string size = "4k";                        ///< one of size_names
  int regions = 1;
  bool response = false;  ///< the response model, in place of the corrected skeleton

  /// "box/4k/1", "response/4k/1"
  [[nodiscard]] std::string name() const;
};

/// Number of triangles for a name such as "4k". @throws scene::InputError for another name
[[nodiscard]] int triangles_wished(const std::string& size);

/// Every body, size and number of regions; the quick list leaves out what no target needs.
[[nodiscard]] std::vector<Case> all_cases(bool quick);

/// Whether a name such as "box/4k/1" begins with the pattern, part by part; "*" is any part.
[[nodiscard]] bool matches(const std::string& name, const std::string& pattern);

/// Balls of equal size as one mesh of separate pieces: icosahedra, every triangle cut in four `halvings` times, their
/// vertices on the balls.
[[nodiscard]] scene::TriangleMesh balls_mesh(const std::vector<scene::Vec3>& centers_m, double radius_m, int halvings);

/// Where the balls of the tool for several regions meet the body's top when they just touch it: up to ten places in
/// rows of 4, 2 and 4, at least 12 mm apart. x and y, from the middle [m].
[[nodiscard]] std::vector<Eigen::Vector2d> contact_places_m(int regions);

/// The case's scene: the paper's rubber. One region: a ball of 10 mm, 2000 samples. Several: that many balls of 4 mm in
/// one mesh, sampled as densely.
[[nodiscard]] scene::Scene scene_of(const Case& which);

/// Columns of the scene's body whose values are made up: the time of a step does not depend on them.
[[nodiscard]] scene::Response made_up_response(const scene::Scene& scene, const scene::Surface& surface);

/// Ticks of the approach, before anything is measured.
inline constexpr std::int64_t approach_ticks = 64;

/// The tool's pose at a tick: from apart to its depth (2.5 mm for one ball, 2.2 mm for several) during the approach,
/// then swaying 0.2 mm about that in depth and place, with periods that have no common divisor, so that no tick
/// repeats the one before.
[[nodiscard]] scene::Pose pose_at_tick(const Case& which, std::int64_t tick);

}  // namespace touchstone::bench
