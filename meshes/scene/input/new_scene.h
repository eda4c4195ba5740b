// A first scene from a few numbers: the text of a commented scene file, with every constant derived from the material.
#pragma once

#include "scene/model/scene.h"

#include <optional>
#include <string>

namespace touchstone::scene {

/// The data of a contact that a user gives. Body and tool need their shapes and dimensions only.
struct NewScene {
  std::string title;
  Body body;                                          ///< shape, dimensions and material
  Tool tool;                                          ///< shape and dimensions, or file and unit
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< where the tool comes down: x and y of its frame
  double depth_m = 0.0;                               ///< beyond first contact, above zero
  double slide_m = 0.0;                               ///< along x at that depth, after pressing; 0: none
  std::optional<double> friction;                     ///< Coulomb's coefficient
};

/// A scene file. @param name  the file's, for the commands in its first lines
[[nodiscard]] std::string new_scene_toml(const NewScene& scene, const std::string& name);

}  // namespace touchstone::scene
