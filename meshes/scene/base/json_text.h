// How every JSON file of ours is written.
#pragma once

#include <string>

namespace touchstone::scene {

/// Indented, with a line feed at its end. Bytes that are no UTF-8, as a file name may have, become U+FFFD.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace touchstone::scene
