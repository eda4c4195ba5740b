// The constants of the fast model that follow from the material and the body's size, with nothing to tune. They are
// rounded to the digits that `touchstone new` writes, so that its scene and the untuned model are one.
#pragma once

#include "scene/model/scene.h"

namespace touchstone::scene {

/// k1_per_radius_n_per_m2 of the area-aware law on a half space; E* = E / (1 - nu^2). A flat tool: 2 E*, both
/// formulations. A rounded tool, corrected formulation: 2 E* / sqrt(2), with which the force of a ball is Hertz's. A
/// rounded tool, published formulation: 2 E*, which its own weights bring near Hertz's. A mesh counts as rounded.
/// Four digits.
[[nodiscard]] double area_law_constant_n_per_m2(const Material& material, const Tool& tool, Formulation formulation);

/// s_c = 10 L^2, L the body's size: beams so stiff that the contact moves further than they do. Two digits.
[[nodiscard]] double stiff_beam_area_m2(const Body& body);

}  // namespace touchstone::scene
