// The ticks of a track in virtual time.
#pragma once

#include "scene/scene.h"

#include <vector>

namespace touchstone::fast {

/// A tick; `instant` is the record it makes, or -1.
struct Tick {
  double time_s;
  int instant;
};

/// Ticks at the scene's rate. The tick nearest to an instant takes the instant's own time, so that both sides answer at
/// exactly equal poses.
[[nodiscard]] std::vector<Tick> ticks_of(const scene::Scene& scene);

}  // namespace touchstone::fast
