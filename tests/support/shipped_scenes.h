// The scenes of meshes/scenes, for tests that hold for every one of them.
#pragma once

#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::test {

/// Their names without ".toml", sorted.
inline std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/meshes/scenes")) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

inline scene::Scene shipped_scene(const std::string& name, scene::Formulation formulation) {
  scene::Scene scene = scene::load_scene(source_folder() + "/meshes/scenes/" + name + ".toml", {});
  scene.fast.formulation = formulation;
  return scene;
}

/// "ball-on-cube-press" as gtest takes it for a test's name.
inline std::string test_name(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace touchstone::test
