// The ticks of a track in virtual time.
#pragma once

#include "scene/model/scene.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace touchstone::fast {

/// A tick; `instant` is the record it makes, or -1.
struct Tick {
  double time_s;
  int instant;
};

/// Ticks at the scene's rate, one after the other, so that a long track takes no more memory than a short one. The tick
/// nearest to an instant takes the instant's own time, so that both solvers compute exactly equal poses.
class Ticks {
 public:
  /// @param scene  may go out of scope
  explicit Ticks(const scene::Scene& scene);
  /// The next one, or nothing after the last.
  [[nodiscard]] std::optional<Tick> next();
  /// Upper bound of their number: two instants may share a tick.
  [[nodiscard]] std::int64_t count() const noexcept { return last_ + 1; }

 private:
  [[nodiscard]] bool instant_is_due() const;

  double begin_s_, rate_hz_;
  std::vector<double> instants_s_;
  std::int64_t last_, k_ = 0;  ///< of the regular ticks
  std::size_t instant_ = 0;    ///< the next
  bool taken_ = false;         ///< regular tick k_, by an instant
};

}  // namespace touchstone::fast
