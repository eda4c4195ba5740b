#include "fast/ticks.h"

#include <cmath>
#include <cstdint>

namespace touchstone::fast {

std::vector<Tick> ticks_of(const scene::Scene& scene) {
  const double begin_s = scene.track.front().time_s, end_s = scene.track.back().time_s;
  const std::vector<double> instants_s = scene::instants_s(scene);
  std::vector<Tick> ticks;
  std::size_t next = 0;
  const auto last = static_cast<std::int64_t>(std::llround((end_s - begin_s) * scene.fast.rate_hz));
  for (std::int64_t k = 0; k <= last; ++k) {
    const auto nearest = [&](double time_s) { return std::llround((time_s - begin_s) * scene.fast.rate_hz) <= k; };
    const bool regular = next == instants_s.size() || !nearest(instants_s[next]);
    if (regular) ticks.push_back({begin_s + static_cast<double>(k) / scene.fast.rate_hz, -1});
    // Instants closer together than the ticks each get one of their own.
    for (; next < instants_s.size() && nearest(instants_s[next]); ++next) {
      ticks.push_back({instants_s[next], static_cast<int>(next)});
    }
  }
  return ticks;
}

}  // namespace touchstone::fast
