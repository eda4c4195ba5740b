// Pictures of both deformed bodies at one instant, as SVG: a half-cut view in space and a true-scale section.
#pragma once

#include "compare/errors.h"

#include <string>

namespace touchstone::compare {

/// Three half-cut bodies side by side: the reference and the fast model coloured by how far each point moved, on
/// one scale, and the reference's shape coloured by how far the fast model's points are from there. The body is cut
/// at the tool's centre, so that the tool does not hide the dimple; the tool's own cut is drawn as an outline.
/// @param instant  index of the track instant
[[nodiscard]] std::string half_cut_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                       std::size_t instant);

/// Section at the tool's centre, y constant, true scale, in millimetres: rest outline, both deformed outlines, tool.
/// @param half_width_m  of what is shown around the contact; zero: the whole body
[[nodiscard]] std::string section_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                      std::size_t instant, double half_width_m);

}  // namespace touchstone::compare
