// Opens every file that a user names as input: scenes, studies, gates, parameters, tables, meshes, logs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace touchstone::scene {

/// A kind of file that a user gives.
struct InputKind {
  std::string_view expected;  ///< "a TOML file"
  std::uintmax_t bytes_max;
};
inline constexpr InputKind toml_input{"a TOML file", std::uintmax_t{4} << 20},
    table_input{"a CSV file", std::uintmax_t{256} << 20},
    log_input{"the live.csv of a live run", std::uintmax_t{2} << 30},
    mesh_input{"an STL, OBJ or PLY file", std::uintmax_t{1} << 30};

/// An input file's bytes, or why they cannot be had.
struct Input {
  std::string bytes;
  std::string fault;  ///< empty when all is well: "it is a folder; expected a TOML file of at most 4 MiB"
};

/// Opens a file that a user names: an ordinary file whose size is known and within its kind's limit. A folder, a
/// pipe, a device, a socket or a file such as those of /proc is refused at once; nothing waits and nothing is thrown
/// but std::bad_alloc.
[[nodiscard]] Input read_input(const std::filesystem::path& path, const InputKind& kind);

/// The same. @param what  for the message: "the scene". @throws InputError "cannot read the scene: ..."
[[nodiscard]] std::string require_input(const std::filesystem::path& path, const InputKind& kind,
                                        const std::string& what);

}  // namespace touchstone::scene
