// The report's interactive view: both deformed bodies in three dimensions with the tool, by vtk.js.
#pragma once

#include "compare/errors/errors.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// Instants the view holds, ascending: all where they fit, otherwise evenly spread with the first, the last and the
/// deepest among them. @param points  rest points of the surface
[[nodiscard]] std::vector<std::size_t> viewer_instants(std::size_t count, std::size_t deepest, Eigen::Index points);

/// Markup, data and script, well-formed XHTML that needs nothing else. Without scripts or WebGL a sentence that refers
/// to the still picture below is all that shows. Displacements have single precision.
[[nodiscard]] std::string viewer_section(const scene::Scene& scene, const fast::Run& run,
                                         const reference::Result& result, const Errors& errors);

}  // namespace touchstone::compare
