// Scenes made up by chance: every body, tool and formulation in turn, all else at random.
#pragma once

#include "scene/model/scene.h"
#include "soak/random.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::soak {

/// Scenes of a full turn: every body shape with every tool shape in both formulations.
inline constexpr int scenes_per_turn = 4 * 5 * 2;

/// The shipped mesh tools, each scaled to a largest extent of 1 m.
using ToolMeshes = std::vector<scene::TriangleMesh>;
/// @param folder  meshes/tools
[[nodiscard]] ToolMeshes tool_meshes(const std::filesystem::path& folder);

/// A scene without any broken rule. Bodies of 1 mm to 1 m, tools 1e-3 to 1e3 times as large where the ranges of a scene
/// file allow it, materials over nine decades, laws and settings over all that is sensible and some more. Its track
/// only keeps the tool apart.
/// @param index  body, tool and formulation go in turn with it
[[nodiscard]] scene::Scene random_scene(int index, const ToolMeshes& meshes, Random& random);

/// Body, tool, formulation and what else decides the way through the model, in a few words.
[[nodiscard]] std::string words_for(const scene::Scene& scene);

}  // namespace touchstone::soak
