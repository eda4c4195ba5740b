// Everything the real-time step writes. All storage is taken at construction.
#pragma once

#include "fast/contact/equivalent_point.h"
#include "fast/contact/pull_back.h"
#include "fast/contact/region_force.h"
#include "fast/realtime/stage_clock.h"
#include "fast/skeleton/beam_stress.h"
#include "fast/step/model.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::fast {

/// What went other than planned in a step: bits, ok for none. The answer is finite in every case.
enum class StepStatus : std::uint32_t {
  ok = 0,
  not_finite = 1u << 0,       ///< the pose was invalid; the last valid result was kept
  depth_limited = 1u << 1,    ///< deeper than depth_limit_rel of the body's thickness; press less deep
  law_saturated = 1u << 2,    ///< past the peak of a softening law; raise contact.k3_n_per_m3 or press less deep
  anchors_limited = 1u << 3,  ///< an anchor point moved further than the contact and was limited; raise fast.s_c_m2
  regions_full = 1u << 4,     ///< more contact regions than fast.max_regions; the smallest were left out
  /// Set for a run over a track, never in a step, which sees the tool by its samples alone: at a recorded instant the
  /// tool is inside the body by the exact shapes, and none of its samples is. Raise fast.tool_samples.
  contact_missed = 1u << 5
};
[[nodiscard]] constexpr StepStatus operator|(StepStatus a, StepStatus b) noexcept {
  return static_cast<StepStatus>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr StepStatus& operator|=(StepStatus& a, StepStatus b) noexcept { return a = a | b; }

/// Status bits in words, "ok" for none.
[[nodiscard]] std::string status_text(std::uint32_t status);

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
