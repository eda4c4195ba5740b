// The script of the report's three-dimensional view, with what it uses of vtk.js, as viewer/bundle.js made it.
#pragma once

#include <string_view>

namespace touchstone::compare {

extern const std::string_view viewer_bundle;

}  // namespace touchstone::compare
