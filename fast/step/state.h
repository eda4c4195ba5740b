// Everything the real-time step writes. All storage is taken at construction.
#pragma once

#include "fast/contact/equivalent_point.h"
#include "fast/contact/pull_back.h"
#include "fast/contact/region_force.h"
#include "fast/realtime/stage_clock.h"
#include "fast/skeleton/beam_stress.h"
#include "fast/step/model.h"
#include "fast/step/status.h"

#include <memory>
#include <vector>

namespace touchstone::fast {

/// The tool's poses around a tick.
struct Motion {
  scene::Pose pose;    ///< now, orientation of unit length
  Placement at;        ///< the same
  scene::Pose before;  ///< in the last tick; equal to `pose` in the first
  bool first = true;   ///< nothing is known of the last tick
};

/// A contact region, kept from tick to tick.
struct ContactRegion {
  explicit ContactRegion(std::size_t beams) : ends(beams) {}
  /// Back to before its creation.
  void clear() noexcept;

  bool active = false;
  bool met = false;                       ///< some of the tool has been inside the shape that it meets
  bool created = false;                   ///< met in this tick: friction has no slip path behind it
  int id = 0;                             ///< the smallest number free at its creation
  scene::Vec3 d = -scene::Vec3::UnitZ();  ///< direction of deformation, into the body
  double depth_rel = 0.0;                 ///< deepest point of the last tick over the body's thickness there
  RegionPoints points;                    ///< p_i, a window on FastState::store
  InsideSummary inside;                   ///< of the points as they were found
  RegionExtent extent;
  DeformationOrigin origin;
  RegionForce force;
  FrictionState friction;                            ///< as it begins where the scene has none
  scene::Vec3 displacement_m = scene::Vec3::Zero();  ///< D of the equivalent point contact, world
  BeamEnds ends;                                     ///< what it does to the anchor points

  /// It pushes on the body: not only the tool's back is inside.
  [[nodiscard]] bool pressing() const noexcept { return active && points.count > 0; }
};

/// What a tick with several contact regions keeps and needs besides the regions.
struct SeveralRegionsState {
  explicit SeveralRegionsState(const FastModel& model);

  ClusterScratch scratch;
  RegionTracker tracker;
  std::vector<Cluster> clusters;
  std::vector<TrackedRegion> tracked;
  PullBackScratch pull_back;
  CurrentEnds ends;
  ShapeStack shapes;                               ///< of the regions pressed so far
  std::vector<std::vector<BeamStress>> stress_pa;  ///< per region
  std::vector<int> order;                          ///< of creation: places in FastState::regions
  double bulge_m = 0.0;  ///< largest distance of the last tick's surface outside the rest surface

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// The changing part of the fast model.
struct FastState {
  explicit FastState(const FastModel& model) : FastState(model, model.max_regions) {}
  /// @param max_regions 1 takes everything inside for one region, also of a tool that may have several
  FastState(const FastModel& model, int max_regions);

  PointStore store;
  CellScratch cells;
  CellIntegrals integrals;             ///< kept from tick to tick, for the mass weights
  PointStore probe;                    ///< for looking at poses between two ticks
  std::vector<ContactRegion> regions;  ///< by creation; the first `region_count` are active
  int region_count = 0;
  SurfaceField field;
  std::unique_ptr<SeveralRegionsState> several;  ///< null where there is but one region
  StageClock* clock = nullptr;                   ///< times of the stages, if wanted
  bool deformed = false;                         ///< field differs from rest
  bool placed = false;                           ///< `motion` holds a good pose
  Motion motion;                                 ///< to the last good pose

  void lap(Stage stage) noexcept {
    if (clock != nullptr) clock->lap(stage);
  }
  /// The tool pushes on the body.
  [[nodiscard]] bool in_contact() const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// Force of the body on the tool [N], world.
[[nodiscard]] scene::Vec3 total_force_n(const FastState& state) noexcept;
/// Its torque about the tool's mass centre [N m], world.
[[nodiscard]] scene::Vec3 total_torque_nm(const FastState& state) noexcept;
/// Force of the support on the body [N], world.
[[nodiscard]] scene::Vec3 support_force_n(const FastState& state) noexcept;

}  // namespace touchstone::fast
