// A track's forces and shapes at its instants and nothing else: the many short runs of a fit. The geometry is prepared
// once; the constants of the laws, the skeleton and the local factor change from call to call.
#pragma once

#include "fast/state.h"
#include "fast/ticks.h"

#include <vector>

namespace touchstone::fast {

class Replay {
 public:
  explicit Replay(const scene::Scene& scene);

  /// Total force on the tool at every instant [N]; equal to run()'s bit for bit.
  /// @param scene  that of the constructor but for the constants
  [[nodiscard]] std::vector<scene::Vec3> forces_n(const scene::Scene& scene);

  /// Displacement at every instant, one column per rest point [m]; equal to run()'s bit for bit. Of a tool that can
  /// have one region only, with the forces of the last call of forces_n(), which must have been one.
  [[nodiscard]] std::vector<Eigen::Matrix3Xd> displacements_m(const scene::Scene& scene);

 private:
  FastModel model_;
  std::vector<Tick> ticks_;
  std::vector<scene::Pose> poses_;      ///< at the ticks
  std::vector<ContactRegion> regions_;  ///< of one-region tools, per instant; what the shape follows from
};

}  // namespace touchstone::fast
