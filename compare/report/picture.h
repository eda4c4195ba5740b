// Pictures of the deformed body at one instant, as SVG: a half-cut view in space and a true-scale section.
#pragma once

#include "compare/errors/errors.h"
#include "compare/format/svg_plot.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// What a body is coloured by.
enum class ColourMap { displacement, error };

/// Red, green, blue (0 to 255) at even steps of the scale; equal steps look equally large, also in grey print and to
/// the colour-blind. Displacement: viridis, dark to light. Error: magma backwards, light to dark, so that no error is
/// pale.
[[nodiscard]] const std::vector<std::array<int, 3>>& colour_table(ColourMap map);

/// What the colours of a drawing show.
struct ColourScale {
  ColourMap map;
  double full;  ///< value of the last colour, SI; the first one's is zero
  std::string what;
  bool clipped = false;     ///< some values exceed the scale and have its last colour
  std::string unit = "mm";  ///< of the ticks
  double per_unit = 1e3;    ///< the ticks' numbers over the SI values
};
/// "#rrggbb" at a share of the scale.
[[nodiscard]] std::string colour_at(ColourMap map, double share);
/// A horizontal bar, its ticks and its title below, 48 px high, as parts of an `<svg>` element.
[[nodiscard]] std::string colour_bar(const ColourScale& scale, double left_px, double top_px, double width_px);

/// Three half-cut bodies: the reference and the fast model coloured by how far each point moved, on one scale, and the
/// reference's shape coloured by how far the fast model's points are from there. The body is cut at the tool's centre,
/// so that the tool does not hide the dimple; the tool's own cut is drawn as an outline.
/// @param instant  index of the track instant
[[nodiscard]] std::vector<std::string> half_cut_svgs(const scene::Scene& scene, const fast::Run& run,
                                                     const reference::Result& result, std::size_t instant);

/// The three side by side.
[[nodiscard]] std::string half_cuts_in_a_row(const std::vector<std::string>& half_cuts);

/// One deformed body alone, half-cut likewise and coloured by how far each point moved.
[[nodiscard]] std::string half_cut_svg(const scene::Scene& scene, const scene::Surface& surface,
                                       const scene::InstantRecord& record, const std::string& title);

/// A long tool is drawn up to half the body's size above it [m].
[[nodiscard]] double tool_shown_below_m(const scene::Surface& surface);

struct DeformedBody {
  std::string name;
  Look look;
  const scene::Surface& surface;
  const Eigen::Matrix3Xd& displacement_m;  ///< at the points of that surface
};

/// Section at the tool's centre, y constant, true scale, in millimetres: rest outline, inclusions, tool, bodies. Title
/// and ranges are left to the caller.
/// @param surface  gives the plane and the rest outline
[[nodiscard]] Plot section_plot(const scene::Scene& scene, const scene::Surface& surface, const scene::Pose& pose,
                                const std::vector<DeformedBody>& bodies);

/// Part of a section: centre and half width.
struct Window {
  double x_m, top_m, half_m;
};

/// Where the tool reaches into the rest body, with as much again around.
[[nodiscard]] Window contact_window(const scene::Scene& scene, const scene::Surface& surface,
                                    const scene::InstantRecord& record);

/// Sets the ranges of a section.
void show_contact(Plot& plot, const Window& window);

/// Section at the tool's centre, y constant, true scale, in millimetres: rest outline, both deformed outlines, tool;
/// the reference on its own mesh. Around the contact with the reference's nodes in the plane as dots, and the places
/// where the plane cuts an edge of the fast model's triangles as squares.
/// @param instant  the deepest
[[nodiscard]] std::string section_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                      std::size_t instant, bool around_contact);

/// What the tool exerts on the body across the contact, in the section's plane, per current area; the reference on its
/// own mesh. Nothing where nothing touches.
/// @param instant  the deepest
[[nodiscard]] std::optional<Plot> traction_plot(const scene::Surface& surface, const reference::Result& result,
                                                std::size_t instant);

}  // namespace touchstone::compare
