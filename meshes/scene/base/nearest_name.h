// "Did you mean ...?"
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// The known name with the fewest letters to change, add, drop or swap. @param known  not empty
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// `unknown key "x"; did you mean "y"?`; the latter not for a very long key, nor after the first faults, of which a
/// message shows no more. @param shown  the key as the message has it; @param told  faults so far
[[nodiscard]] std::string unknown_key(const std::string& shown, std::string_view name,
                                      const std::vector<std::string>& known, std::size_t told);

/// `; did you mean "x"?` with the nearest known name; empty where not even half of the letters agree.
[[nodiscard]] std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

/// The same for a file that is not there, from the names in its folder; or that there is no such folder.
[[nodiscard]] std::string did_you_mean_file(const std::filesystem::path& missing);

}  // namespace touchstone::scene
