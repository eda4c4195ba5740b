#include "scene/model/area_law.h"

#include "scene/base/text.h"

#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

/// Hertz's force of a ball, 4/3 E* sqrt(R) D^1.5, over 2 E* a <d>, with a = sqrt(2 R D) and <d> = 2/3 D, the mean depth
/// of the corrected formulation under a ball: its weights decrease as 1 / r with the distance from the centre.
constexpr double rounded_tool_factor = std::numbers::sqrt2 / 2.0;

}  // namespace

double area_law_constant_n_per_m2(const Material& material, const Tool& tool, Formulation formulation) {
  const bool flat = tool.shape == ToolShape::cylinder || tool.shape == ToolShape::box;
  return rounded(
      2.0 * material.contact_modulus_pa() * (flat || formulation == Formulation::published ? 1.0 : rounded_tool_factor),
      4);
}

double stiff_beam_area_m2(const Body& body) { return rounded(10.0 * std::pow(body_size_m(body), 2), 2); }

}  // namespace touchstone::scene
