// What a track has in it before any law: the one contact region of every tick, found and measured, for the many times
// that a fit runs the same track with other constants.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"
#include "scene/model/scene.h"

#include <optional>
#include <vector>

namespace touchstone::fast {

/// One tick.
struct RecordedTick {
  int instant = -1;        ///< place among the instants; -1 for a tick between them
  bool in_region = false;  ///< something of the tool is inside
  bool created = false;    ///< for the first time
  Motion motion;
  scene::Vec3 d = scene::Vec3::Zero();
  RegionExtent extent;
  DeformationOrigin origin;  ///< as the points have it, without friction's drag
  int points = 0;
  bool spread = false;          ///< RegionPoints::spread
  std::vector<double> numbers;  ///< x_T, y_T, z_T, depth, rises and mass weight of every point, column by column
};

/// The ticks on which the answer at the instants depends: with friction, which has a memory, all of them, else those of
/// the instants. Nothing if the constants could change which samples form which region. A tool that may have several
/// regions has one at every tick, for any constants, if
/// - it has no friction, so that no anchor point moves further than the tick's deepest sample is deep and the surface
///   extends outside the rest surface by at most that;
/// - at every tick the samples inside are one cluster, and every sample outside but within reach of the last tick's
///   surface is nearer than r_th to one inside, so that it joins them or is left out;
/// - from tick to tick it keeps a sample, and once it has left the body nothing is within reach.
/// @param bytes_max  a recording that would take more is given up
[[nodiscard]] std::optional<std::vector<RecordedTick>> record_one_region(const FastModel& model,
                                                                         const scene::Scene& scene,
                                                                         std::size_t bytes_max);

/// Puts the tick into a state with one region, as Parts::find and Parts::measure leave it. The state borrows the tick's
/// points.
void recall(const RecordedTick& tick, FastState& state) noexcept;

}  // namespace touchstone::fast
