// The scene as an input deck of CalculiX, an independent finite element code: the same mesh, material, contact and
// track, solved by elements and a contact method that are independent of the reference.
#pragma once

#include "scene/base/error.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace touchstone::reference {

struct DeckOptions {
  int level = 0;  ///< of the refinement sequence, 0 the coarsest
  /// Contact pressure over overclosure; absent: what costs about a thousandth of the force.
  std::optional<double> contact_stiffness_pa_per_m{};
};

/// Names that the deck's output goes by.
inline constexpr const char* deck_tool_set = "TOOL";
inline constexpr const char* deck_surface_set = "SURFACE";

/// An input deck and what is needed to read the answer.
struct Deck {
  std::string text;
  std::string model;                  ///< "axisymmetric CAX8R finite strain"
  int nodes = 0;                      ///< of the body
  scene::Vec3 whole_body;             ///< a total force of the deck times this, by component, is the whole body's
  std::vector<int> instants;          ///< of scene::instants_s: the one that each step of the deck ends at
  std::vector<int> surface_nodes;     ///< of deck_surface_set, rising
  Eigen::Matrix3Xd surface_points_m;  ///< the same at rest, world frame; dim = 2: in the half plane y = 0, x >= 0
  bool axisymmetric = false;          ///< displacements are (u_r, u_z, 0)
};

/// What of the scene CalculiX has no counterpart for: an incompressible material.
[[nodiscard]] std::vector<scene::Fault> unsupported_in_deck(const scene::Scene& scene);
inline constexpr double largest_deck_poissons_ratio = 0.49;

/// The mesh is the reference's of that level, its 9- and 27-node cells without their middles: CAX8R in axisymmetric
/// models, C3D20R otherwise, with a linear equation for every node on the side of a larger cell. Finite strain becomes
/// the neo-Hookean law with C10 = mu / 2 and D1 = 2 / kappa, small strain linear elasticity; a cell is of the material
/// at its middle. The tool is a coat of elements with every node moved; contact is from surface to surface with a
/// linear pressure over overclosure. Friction is Coulomb's with mu_D: CalculiX has no power law.
/// @throws scene::InputError with the faults of unsupported_in_deck or when there is never contact
[[nodiscard]] Deck calculix_deck(const scene::Scene& scene, const DeckOptions& options);

}  // namespace touchstone::reference
