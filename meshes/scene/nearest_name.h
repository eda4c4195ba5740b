// "Did you mean ...?"
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// The known name with the fewest letters to change, add, drop or swap. @param known  not empty
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace touchstone::scene
