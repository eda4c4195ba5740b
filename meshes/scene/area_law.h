// The constant of the area-aware contact law that follows from the material, with nothing to tune.
#pragma once

#include "scene/scene.h"

namespace touchstone::scene {

/// k1_per_radius_n_per_m2 of the area-aware law on a half space; E* = E / (1 - nu^2). A flat tool: 2 E*, both
/// formulations. A rounded tool, corrected formulation: 2 E* / sqrt(2), with which the force of a ball is Hertz's. A
/// rounded tool, published formulation: 2 E*, which its own weights bring near Hertz's. A mesh counts as rounded.
[[nodiscard]] double area_law_constant_n_per_m2(const Material& material, const Tool& tool, Formulation formulation);

}  // namespace touchstone::scene
