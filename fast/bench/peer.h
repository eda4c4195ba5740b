// Another simulator in the benchmark: its deformable body under the same press, in turn with ours.
#pragma once

#include "fast/bench/measure.h"

#include <functional>
#include <string>
#include <vector>

namespace touchstone::bench {

/// What Bullet was asked to compute.
struct PeerSetting {
  std::string name;  ///< such as "rubber.implicit"
  double youngs_modulus_pa = 0.0, poissons_ratio = 0.0;
  bool implicit = true;
};

/// Bullet's body with one setting on a box of one size.
struct PeerResult {
  std::string size;  ///< "1k" or "4k"
  PeerSetting setting;
  int triangles = 0, tetrahedra = 0, ticks = 0;
  bool sound = false;                  ///< every node stayed at a finite place near its own
  bool touching = false;               ///< the surface moved as far as the ball, without penetration
  double dent_m = 0.0, depth_m = 0.0;  ///< under the ball, at the last tick
  Durations step;                      ///< of Bullet
  double our_step_us = not_measured;   ///< median of our step on the same box in the same minutes, wall clock

  /// It computed what it was asked to, and its time may be quoted.
  [[nodiscard]] bool valid() const noexcept { return sound && touching && ticks > 0; }
  /// Its thread's own time over our time by the wall clock: its steps are long enough for other processes to come in
  /// between, ours are not. NaN unless valid.
  [[nodiscard]] double over_step() const noexcept;
};

/// The paper's rubber, as near to incompressible as Bullet goes, and its PVC, a hundred times softer, which lets
/// explicit steps of 1 ms hold.
[[nodiscard]] std::vector<PeerSetting> peer_settings();

/// The fastest valid one of a size whose name begins so; null where there is none.
[[nodiscard]] const PeerResult* fastest(const std::vector<PeerResult>& peers, const std::string& size,
                                        const std::string& begins);

/// Name and version of the other simulator in this build: "Bullet 3.24", or empty.
[[nodiscard]] std::string peer_version();

/// Every setting on the box of one size, in turn with our step. Empty if this build has no other simulator.
/// @param settings those to try
[[nodiscard]] std::vector<PeerResult> measure_peer(const std::string& size, const std::vector<PeerSetting>& settings,
                                                   bool quick, const std::function<void(const std::string&)>& progress);

}  // namespace touchstone::bench
