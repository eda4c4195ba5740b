// Rules that tie several keys of a scene together; single keys are checked against fields.cc.
#pragma once

#include "scene/model/scene.h"

#include <string>
#include <vector>

namespace touchstone::scene {

/// A broken rule and the key it is reported at, such as "track[2].time_s".
struct Violation {
  std::string key, message;
};

/// Those without which body and tool have no shapes.
[[nodiscard]] std::vector<Violation> broken_shapes(const Scene& scene);

/// Every broken rule of a scene whose single values are all in range.
[[nodiscard]] std::vector<Violation> broken_rules(const Scene& scene);

/// Those of the fast model's constants alone, for a search that changes nothing else.
/// @param deepest_m  the track's largest rest depth
[[nodiscard]] std::vector<Violation> broken_constants(const Scene& scene, double deepest_m);

}  // namespace touchstone::scene
