// Everything the real-time step writes. All storage is taken at construction.
#pragma once

#include "fast/skeleton/beam_skeleton.h"
#include "fast/contact/equivalent_point.h"
#include "fast/surface/interpolation.h"
#include "fast/step/model.h"
#include "fast/contact/region_force.h"
#include "fast/realtime/stage_clock.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::fast {

/// What was limited or failed in a step: bits, ok for none. The answer is finite in every case.
enum class StepStatus : std::uint32_t {
  ok = 0,
  not_finite = 1u << 0,       ///< the pose was not a finite placement; the last good answer was held
  depth_limited = 1u << 1,    ///< deeper than depth_limit_rel of the body's thickness; press less deep
  law_saturated = 1u << 2,    ///< past the peak of a softening law; raise contact.k3_n_per_m3 or press less deep
  anchors_limited = 1u << 3,  ///< an anchor point would move farther than the contact; raise fast.s_c_m2
  regions_full = 1u << 4,     ///< more contact regions than fast.max_regions; the smallest were left out
  /// Set by a run over a track, never by a step, which has the tool's samples only: at a recorded instant the tool is
  /// inside the body by the exact shapes, and none of its samples is. Raise fast.tool_samples.
  contact_missed = 1u << 5
};
[[nodiscard]] constexpr StepStatus operator|(StepStatus a, StepStatus b) noexcept {
  return static_cast<StepStatus>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr StepStatus& operator|=(StepStatus& a, StepStatus b) noexcept { return a = a | b; }

/// Status bits in words, "ok" for none.
[[nodiscard]] std::string status_text(std::uint32_t status);

struct SeveralRegionsState;

/// A contact region, kept from tick to tick.
struct ContactRegion {
  explicit ContactRegion(std::size_t beams) : ends(beams) {}
  /// Back to before its creation.
  void clear() noexcept;

  bool active = false;
  bool met = false;                       ///< the tool has been inside the shape that this region contacts
  int id = 0;                             ///< the smallest number free at its creation
  scene::Vec3 d = -scene::Vec3::UnitZ();  ///< direction of deformation, into the body
  double depth_rel = 0.0;                 ///< deepest point of the last tick over the body's thickness there
  RegionPoints points;                    ///< p_i, a window on FastState::store
  RegionExtent extent;
  DeformationOrigin origin;
  RegionForce force;
  FrictionState friction;                            ///< as it begins where the scene has none
  scene::Vec3 displacement_m = scene::Vec3::Zero();  ///< D of the equivalent point contact, world
  BeamEnds ends;                                     ///< displacements and forces of the anchor points

  /// It pushes on the body: not only surfaces facing away from it are inside.
  [[nodiscard]] bool pressing() const noexcept { return active && points.count > 0; }
};

/// The changing part of the fast model.
struct FastState {
  explicit FastState(const FastModel& model);
  ~FastState();

  PointStore store;
  CellScratch cells;
  PointStore probe;                    ///< for poses between two ticks
  std::vector<ContactRegion> regions;  ///< by creation; the first `region_count` are active
  int region_count = 0;
  SurfaceField field;
  std::unique_ptr<SeveralRegionsState> several;  ///< null where the model has one region
  StageClock* clock = nullptr;                   ///< laps at the end of every stage, if set
  bool deformed = false;                         ///< field differs from rest
  bool placed = false;                           ///< `pose` holds a good pose
  scene::Pose pose;                              ///< last good pose, its orientation of unit length

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
