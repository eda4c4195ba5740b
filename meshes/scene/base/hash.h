// Content addresses.
#pragma once

#include <string>
#include <string_view>

namespace touchstone::scene {

/// XXH3, 128 bits, as 32 hexadecimal digits. For identity, not for security.
[[nodiscard]] std::string hash_text(std::string_view text);

}  // namespace touchstone::scene
