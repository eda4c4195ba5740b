// A track's forces and shapes at its instants and nothing else: the many short runs of a fit. The geometry is prepared
// once; the constants of the laws, the skeleton and the local factor change from call to call.
#pragma once

#include "fast/run/recording.h"
#include "fast/step/skeleton_engine.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace touchstone::fast {

class Replay {
 public:
  /// @param bytes_max  of what is kept of the ticks; where it does not suffice, every call steps through them anew, as
  ///                   with the response model
  explicit Replay(const scene::Scene& scene, std::size_t bytes_max = std::size_t{512} << 20);

  /// Total force on the tool at every instant [N]; equal to run()'s bit for bit.
  /// @param scene  the constructor's, with other constants
  [[nodiscard]] std::vector<scene::Vec3> forces_n(const scene::Scene& scene);

  /// Displacement at some instants, equal to run()'s bit for bit. Where recorded(), with the forces of the last call of
  /// forces_n(), which must have been one.
  /// @param instants  in rising order; @param visit  gets a place among them and the displacement of all rest points
  /// [m]
  void displacements(const scene::Scene& scene, std::span<const std::size_t> instants,
                     const std::function<void(std::size_t, const Columns3&)>& visit);

  /// Whether the regions could be found, measured and kept beforehand, see record_one_region().
  [[nodiscard]] bool recorded() const noexcept { return recorded_.has_value(); }

 private:
  std::unique_ptr<Engine> engine_;
  SkeletonEngine* skeleton_;  ///< the same; null where it is another
  double r_th_m_;             ///< of the constructor's scene
  std::optional<std::vector<RecordedTick>> recorded_;
  std::vector<ContactRegion> regions_;  ///< where recorded, per instant; what the shape follows from
};

}  // namespace touchstone::fast
