// What must hold after every tick, for any scene and pose, and how often it was checked.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::soak {

enum class Property {
  finite,         ///< force, torque, regions, beams and the whole surface are finite numbers
  reported,       ///< whatever was limited or dropped has its status bit
  bad_pose_held,  ///< an invalid pose has its status bit and changes nothing
  rest,           ///< without contact: no force, and the shape at rest to rest_tolerance_m
  memory,         ///< resident memory within a scene and from scene to scene
  energy          ///< work gained on closed paths
};
inline constexpr std::size_t properties = 6;

inline constexpr double rest_tolerance_m = 1e-6;

struct Looked {
  std::int64_t times = 0, faults = 0;
};

/// Figures of the whole run.
struct Figures {
  std::array<Looked, properties> looked;
  std::int64_t ticks = 0, in_contact = 0, several_regions = 0, sliding = 0, contacts_ended = 0;
  std::array<std::int64_t, 5> bits{};  ///< ticks with each bit of StepStatus
  double farthest_from_rest_m = 0.0;   ///< largest displacement without contact

  [[nodiscard]] std::int64_t faults() const;
};

/// Checks one scene's model and state after each tick.
class Watch {
 public:
  /// @param report  gets a sentence for every fault
  Watch(const fast::FastModel& model, fast::FastState& state, Figures& figures,
        std::function<void(Property, const std::string&)> report);

  /// Before a step: stores what the step must not change or will overwrite.
  void before_step() noexcept;
  /// After a step.
  void after_step(const scene::Pose& asked, fast::StepStatus status);

 private:
  void check(Property property, bool holds, const std::string& otherwise);
  void check_finite();
  void check_reported(fast::StepStatus status);
  void check_regions_full(const scene::Pose& pose, fast::StepStatus status);
  void check_rest();

  const fast::FastModel& model_;
  fast::FastState& state_;
  Figures& figures_;
  std::function<void(Property, const std::string&)> report_;
  std::int64_t tick_ = 0;
  bool was_in_contact_ = false;
  double bulge_m_ = 0.0;
  scene::Vec3 force_n_ = scene::Vec3::Zero(), position_m_ = scene::Vec3::Zero();
  fast::CellScratch cells_;
  std::vector<int> group_;
};

/// Resident memory of this process [bytes].
[[nodiscard]] std::int64_t resident_bytes();

}  // namespace touchstone::soak
