// The floor of the benchmark: what writing the answer costs when nothing is computed.
#pragma once

#include "fast/surface/surface_patches.h"

namespace touchstone::bench {

/// Copies six columns of floats, the displacement and the normal of every vertex, from one place in memory to another.
class CopyFloor {
 public:
  explicit CopyFloor(const fast::SurfaceField& at_rest);
  /// The compiler cannot leave it out or keep part of it for later.
  void copy() noexcept;
  [[nodiscard]] const fast::SurfaceField& from() const noexcept { return from_; }
  [[nodiscard]] const fast::SurfaceField& to() const noexcept { return to_; }

 private:
  fast::SurfaceField from_, to_;
};

}  // namespace touchstone::bench
