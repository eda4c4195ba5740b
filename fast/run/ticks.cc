#include "fast/run/ticks.h"

#include <cmath>

namespace touchstone::fast {

Ticks::Ticks(const scene::Scene& scene)
    : begin_s_(scene.track.front().time_s),
      rate_hz_(scene.fast.rate_hz),
      instants_s_(scene::instants_s(scene)),
      last_(std::llround((scene.track.back().time_s - begin_s_) * rate_hz_)) {}

bool Ticks::instant_is_due() const {
  return instant_ < instants_s_.size() && std::llround((instants_s_[instant_] - begin_s_) * rate_hz_) <= k_;
}

std::optional<Tick> Ticks::next() {
  for (; k_ <= last_; ++k_, taken_ = false) {
    // If instants are closer than the ticks, each instant gets a tick of its own.
    if (instant_is_due()) {
      taken_ = true;
      const std::size_t instant = instant_++;
      return Tick{instants_s_[instant], static_cast<int>(instant)};
    }
    if (!taken_) {
      taken_ = true;
      return Tick{begin_s_ + static_cast<double>(k_) / rate_hz_, -1};
    }
  }
  return std::nullopt;
}

}  // namespace touchstone::fast
