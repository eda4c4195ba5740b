// A first scene from a few numbers: the text of a commented scene file, with every constant derived from the material.
#pragma once

#include "scene/scene.h"

#include <optional>
#include <string>

namespace touchstone::scene {

/// What a user says of a contact. Body and tool need their shapes and dimensions only.
struct NewScene {
  std::string title;
  Body body;                                          ///< shape, dimensions and material
  Tool tool;                                          ///< shape and dimensions, or file and unit
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< where the tool comes down: x and y of its frame
  double depth_m = 0.0;                               ///< beyond first contact, above zero
  double slide_m = 0.0;                               ///< along x at that depth, after pressing; 0: none
  std::optional<double> friction;                     ///< Coulomb's coefficient
};

/// k1_per_radius_n_per_m2 of the area-aware law for a half space: 2 E* under a flat tool, 2 E* / sqrt(2) under a
/// rounded one, with which the corrected formulation's force of a ball is Hertz's; E* = E / (1 - nu^2).
[[nodiscard]] double area_law_constant_n_per_m2(const Material& material, const Tool& tool);

/// A scene file. @param name  the file's, for the commands in its first lines
[[nodiscard]] std::string new_scene_toml(const NewScene& scene, const std::string& name);

}  // namespace touchstone::scene
