// Everything the real-time step writes. All storage is taken at construction.
#pragma once

#include "fast/beam_skeleton.h"
#include "fast/equivalent_point.h"
#include "fast/interpolation.h"
#include "fast/model.h"
#include "fast/region_force.h"

#include <cstdint>

namespace touchstone::fast {

/// What went other than planned in a step: bits, ok for none. The answer is finite in every case.
enum class StepStatus : std::uint32_t {
  ok = 0,
  not_finite = 1u << 0,      ///< the pose was not a finite placement; the last good answer was held
  depth_limited = 1u << 1,   ///< deeper than depth_limit_rel of the body's thickness; press less deep
  law_saturated = 1u << 2,   ///< past the peak of a softening law; raise contact.k3_n_per_m3 or press less deep
  anchors_limited = 1u << 3  ///< an anchor point outran the contact and was held back; raise fast.s_c_m2
};
[[nodiscard]] constexpr StepStatus operator|(StepStatus a, StepStatus b) noexcept {
  return static_cast<StepStatus>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr StepStatus& operator|=(StepStatus& a, StepStatus b) noexcept { return a = a | b; }

/// The one contact region, kept from tick to tick.
struct ContactRegion {
  bool active = false;
  scene::Vec3 d = -scene::Vec3::UnitZ();  ///< direction of deformation, into the body
  double depth_rel = 0.0;                 ///< deepest point of the last tick over the body's thickness there
  RegionExtent extent;
  DeformationOrigin origin;
  RegionForce force;
  double displacement_m = 0.0;  ///< D of the equivalent point contact
};

/// The changing part of the fast model.
struct FastState {
  explicit FastState(const FastModel& model);

  RegionPoints points;
  ContactRegion region;
  BeamEnds ends;
  SurfaceField field;
  bool deformed = false;  ///< field differs from rest
  bool placed = false;    ///< `pose` holds a good pose
  scene::Pose pose;       ///< last good pose, its orientation of unit length

  /// The tool pushes on the body.
  [[nodiscard]] bool in_contact() const noexcept { return region.active && points.count > 0; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

}  // namespace touchstone::fast
