// Is a text well-formed XML?
#pragma once

#include <string>

namespace touchstone::compare::testing {

[[nodiscard]] bool is_well_formed(const std::string& xml);

/// Does a number that is not finite show anywhere as one? Words that contain the letters do not count.
[[nodiscard]] bool shows_not_a_number(const std::string& text);

}  // namespace touchstone::compare::testing
