// The script of the report's view in space, as the build took it from viewer/viewer.bundle.js.
#pragma once

#include <string_view>

namespace touchstone::compare {

extern const std::string_view viewer_bundle;

}  // namespace touchstone::compare
