// What the fast model alone computed, as drawings: force, contact area, friction, path and shape, each only where the
// scene has it.
#pragma once

#include "compare/format/svg_plot.h"
#include "fast/run/run.h"
#include "scene/model/scene.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// One drawing of a page and of a file of its own.
struct Drawing {
  std::string name;     ///< of the file, without ".svg"
  std::string caption;  ///< may be empty
  std::string svg;
  bool wide = false;  ///< takes the width of two
};

/// Names of all drawings any scene can have.
[[nodiscard]] const std::vector<std::string>& drawing_names();

/// None where there is never contact. Else "force" over time; with friction "friction"; with several regions
/// at a time "regions"; normal force over "depth"; contact "area"; where the tool travels sideways while pressed
/// "path", with friction also "friction-path".
[[nodiscard]] std::vector<Drawing> force_drawings(const scene::Scene& scene, const fast::Run& run);

/// "section" of the whole body at instants_shown(); where there is ever contact also around the "contact", the
/// "dent" in the section, and a "view" in space at the middle instant or that with most regions.
[[nodiscard]] std::vector<Drawing> shape_drawings(const scene::Scene& scene, const fast::Run& run);

/// Instants worth a section. Several regions at a time: of the six longest stages with one number of regions, that
/// where the shallowest is deepest. Else where the tool travels sideways while pressed, both ends and the middle of its
/// way. Else the deepest. Of equal ones the last.
[[nodiscard]] std::vector<std::size_t> instants_shown(const fast::Run& run);

/// Intervals of time "stuck" and "sliding"; an instant represents the time nearer to it than to its neighbours. Several
/// regions slide when one does.
[[nodiscard]] std::vector<Span> friction_spans(const fast::Run& run);

}  // namespace touchstone::compare
