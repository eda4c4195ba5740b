// Whether a text is well-formed XML.
#pragma once

#include <string>

namespace touchstone::compare::testing {

[[nodiscard]] bool is_well_formed(const std::string& xml);

/// Whether a number that is not finite is visible anywhere. Words that contain its letters do not count.
[[nodiscard]] bool shows_not_a_number(const std::string& text);

}  // namespace touchstone::compare::testing
