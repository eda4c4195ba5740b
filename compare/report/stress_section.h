// The stress inside the body in the section at the tool's centre, as SVG.
#pragma once

#include "reference/run/inside.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <string>

namespace touchstone::compare {

/// Points of a section, y constant, in columns from the bottom up: closer to each other near the contact.
struct SectionGrid {
  Eigen::Matrix3Xd rest_m;  ///< world frame
  Eigen::Index rows = 0;    ///< of every column
};
/// @param surface  gives the plane and the body's outline, which is convex
[[nodiscard]] SectionGrid section_grid(const scene::Surface& surface, const scene::Pose& tool);

/// Von Mises' stress in colours where the points have moved to, and the tool's outline; true scale.
/// @param values  at the grid's points
[[nodiscard]] std::string stress_section_svg(const scene::Scene& scene, const scene::Surface& surface,
                                             const scene::InstantRecord& record, const SectionGrid& grid,
                                             const reference::PointValues& values);

/// Largest stress in the section and its place, a sentence.
[[nodiscard]] std::string stress_section_caption(const SectionGrid& grid, const reference::PointValues& values);

}  // namespace touchstone::compare
