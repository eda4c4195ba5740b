// Scene files: TOML in, resolved TOML out. The keys and their ranges are declared in fields.cc.
#pragma once

#include "scene/base/error.h"
#include "scene/model/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::scene {

/// Reads and validates a scene file.
/// @param overrides  "body.material.youngs_modulus_pa=2e6" and the like, applied over the file
/// @throws InputError with every fault of the file at once, each with line, column and expected range
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text.
/// @param file   name for error messages; a track file is looked for beside it
[[nodiscard]] Scene parse_scene(const std::string& text, const std::filesystem::path& file,
                                const std::vector<std::string>& overrides = {});

/// Every value in force, as a scene file that loads to the same scene; the track is written out.
[[nodiscard]] std::string resolved_toml(const Scene& scene);

/// The same with every key's meaning as a comment behind it: what `plan` shows.
[[nodiscard]] std::string explained_toml(const Scene& scene);

/// XXH3 (128 bits, hexadecimal) of the resolved scene without its title: the scene's identity in results.
[[nodiscard]] std::string scene_hash(const Scene& scene);

}  // namespace touchstone::scene
