// Closed paths of the tool, and the work of the contact along them.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"
#include "scene/model/scene.h"
#include "soak/random_device.h"

#include <functional>
#include <vector>

namespace touchstone::soak {

/// Ticks of one round.
inline constexpr int ticks_per_round = 100;

enum class PathKind {
  level,           ///< no rotation; any lateral motion, with the same depths back as forth
  there_and_back,  ///< any motion with rotation, and back through the same poses
  loop             ///< any motion with rotation
};

struct ClosedPath {
  PathKind kind;
  std::vector<scene::Pose> poses;  ///< of one round; the last is the first
  Touch touch;                     ///< the pose of first touch
};
[[nodiscard]] ClosedPath closed_path(PathKind kind, const fast::FastModel& model, Random& random);

/// What happened in the second of two rounds.
struct RoundWork {
  double gained_j = 0.0;       ///< work gained by the tool: sum of F dx + T dphi, forces by the mean of two ticks
  double turned_over_j = 0.0;  ///< sum of the absolute values of its parts
  bool always_in_contact = true;
  bool steady =
      true;  ///< one region at a time, with or without force, whose direction is Touch::normal to 1e-9 throughout
  /// All cells and samples below the plane of the touch were in the body, and their exit was through that plane.
  bool flat = true;
  double deepest_rel = 0.0;  ///< largest depth over the body's thickness
};
/// @param step  steps the state to a pose
[[nodiscard]] RoundWork go_round(const fast::FastModel& model, const fast::FastState& state, const ClosedPath& path,
                                 const std::function<void(const scene::Pose&)>& step);

}  // namespace touchstone::soak
