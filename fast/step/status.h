// What went other than planned in a step.
#pragma once

#include <cstdint>
#include <string>

namespace touchstone::fast {

/// Bits, ok for none. The answer is finite in every case.
enum class StepStatus : std::uint32_t {
  ok = 0,
  not_finite = 1u << 0,       ///< the pose was invalid; the last valid result was kept
  depth_limited = 1u << 1,    ///< deeper than depth_limit_rel of the body's thickness; press less deep
  law_saturated = 1u << 2,    ///< past the peak of a softening law; raise contact.k3_n_per_m3 or press less deep
  anchors_limited = 1u << 3,  ///< an anchor point moved further than the contact and was limited; raise fast.s_c_m2
  regions_full = 1u << 4,     ///< more contact regions than fast.max_regions; the smallest were left out
  /// Set for a run over a track, never in a step, which sees the tool by its samples alone: at a recorded instant the
  /// tool is inside the body by the exact shapes, and none of its samples is. Raise fast.tool_samples.
  contact_missed = 1u << 5,
  // Of the response model:
  outside_grid = 1u << 6,  ///< the load is outside the grid of the response; its nearest place was used
  tip_exceeded = 1u << 7,  ///< deeper than the tool's tip is high
  tilted = 1u << 8,        ///< a flat tip that does not lie flat
  // Beyond what the response model was compared with the reference for (fast/response/checked_range.h):
  depth_unchecked = 1u << 9,       ///< deeper, over the tip's radius
  size_unchecked = 1u << 10,       ///< a larger contact, over the body's size
  edge_unchecked = 1u << 11,       ///< nearer to an edge of the body, over the contact's radius
  regions_unchecked = 1u << 12,    ///< two contacts nearer to each other, over their radii
  curvature_unchecked = 1u << 13,  ///< a more curved body, over the tip's radius
  material_unchecked = 1u << 14,   ///< a Poisson's ratio below 0.5 with friction or another tip than a ball
  inclusion_unchecked = 1u << 15   ///< a body with inclusions
};
[[nodiscard]] constexpr StepStatus operator|(StepStatus a, StepStatus b) noexcept {
  return static_cast<StepStatus>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr StepStatus& operator|=(StepStatus& a, StepStatus b) noexcept { return a = a | b; }
/// What the response model was not compared with the reference for.
inline constexpr StepStatus unchecked = StepStatus::depth_unchecked | StepStatus::size_unchecked |
                                        StepStatus::edge_unchecked | StepStatus::regions_unchecked |
                                        StepStatus::curvature_unchecked | StepStatus::material_unchecked |
                                        StepStatus::inclusion_unchecked;

/// Status bits in words, "ok" for none.
[[nodiscard]] std::string status_text(std::uint32_t status);

}  // namespace touchstone::fast
