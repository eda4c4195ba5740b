// The real-time pipeline over a scene's track in virtual time: what `touchstone fast` does.
#pragma once

#include "fast/run/percentiles.h"
#include "fast/skeleton/beam_stress.h"
#include "scene/model/answer.h"
#include "scene/model/plan.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::fast {

/// What a contact region does to one beam end at one instant.
struct BeamRecord {
  double time_s = 0.0;
  int region_id = 0;
  int anchor = 0;              ///< of AnchorPoints::points_m
  scene::Vec3 anchor_m;        ///< at rest, world
  scene::Vec3 displacement_m;  ///< world; zero where held
  scene::Vec3 force_n;         ///< F_i, on the beam at its other end, world
  BeamStress end;              ///< all zero where the region only keeps its place
};

/// The answer over the whole track, with what only this model can tell.
struct Run : scene::Answer {
  std::vector<BeamRecord> beams;  ///< per instant, pressing region and anchor point
  Percentiles step;               ///< whole step, wall clock, over all ticks of the track; to 1 %
  Percentiles force;              ///< detection to published force, ticks in contact only; to 1 %
  double setup_s = 0.0;           ///< building the model
  std::size_t memory_bytes = 0;   ///< model and state
  std::int64_t ticks = 0;
  int regions_max = 0;
  std::optional<double> first_contact_s;  ///< by Separation; absent where the tool stays apart
  /// Effect of the order of several regions, which the paper leaves open (errata E18), worst over the instants; see
  /// OrderSpread. Absent where no instant had several.
  std::optional<double> order_spread_rel, equilibrium_rel;
  std::uint32_t status = 0;      ///< OR of all StepStatus bits
  std::uint64_t state_hash = 0;  ///< Engine::answer_hash(); equal on replay
};

/// What the fast model computes for this scene and what it leaves out.
[[nodiscard]] scene::Plan plan(const scene::Scene& scene);

/// Runs the whole track at fast.rate_hz. Deterministic except for the timings. The memory depends on the instants, not
/// on the ticks.
/// @param progress called now and then with the fraction done; may be empty
[[nodiscard]] Run run(const scene::Scene& scene, const std::function<void(double)>& progress = {});

}  // namespace touchstone::fast
