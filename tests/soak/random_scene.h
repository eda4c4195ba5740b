// Random scenes: every body, tool and formulation in turn, everything else at random.
#pragma once

#include "scene/model/scene.h"
#include "soak/random.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::soak {

/// Scenes until every body shape has occurred with every tool shape in both formulations.
inline constexpr int scenes_per_turn = 4 * 5 * 2;

/// The shipped mesh tools, each scaled to a largest extent of 1 m.
using ToolMeshes = std::vector<scene::TriangleMesh>;
/// @param folder  meshes/tools
[[nodiscard]] ToolMeshes tool_meshes(const std::filesystem::path& folder);

/// A valid scene. Bodies of 1 mm to 1 m, tools 1e-3 to 1e3 times as large if the ranges of a scene file allow it,
/// materials over nine decades, laws and settings over all sensible values and some more. Its track keeps the tool
/// apart.
/// @param index  selects body, tool and formulation in turn
[[nodiscard]] scene::Scene random_scene(int index, const ToolMeshes& meshes, Random& random);

/// Body, tool, formulation and other choices that decide which stages run, in a few words.
[[nodiscard]] std::string words_for(const scene::Scene& scene);

}  // namespace touchstone::soak
