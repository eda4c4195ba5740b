// Texts of tests: whether one is well-formed XML, and what stands in it.
#pragma once

#include <string>

namespace touchstone::compare::testing {

[[nodiscard]] bool is_well_formed(const std::string& xml);

/// Whether a number that is not finite is visible anywhere. Words that contain its letters do not count.
[[nodiscard]] bool shows_not_a_number(const std::string& text);

/// How often a part stands in a text.
[[nodiscard]] std::size_t count_of(const std::string& text, const std::string& part);

}  // namespace touchstone::compare::testing
