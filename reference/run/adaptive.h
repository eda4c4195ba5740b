// The meshes of a scene's refinement sequence: of the fixed family, or refined where an estimate finds the error.
#pragma once

#include "reference/discretisation/discretisation.h"
#include "reference/run/model_choice.h"
#include "reference/run/store.h"
#include "reference/run/uncertainty.h"
#include "scene/model/scene.h"

#include <vector>

namespace touchstone::reference {

/// Mesh of a level, 0 the coarsest: level_mesh(), or with reference.adaptive_share the coarser one with cells divided.
/// Which cells, the store keeps. Where it does not have them they are found from the coarser level's solutions in it:
/// each instant's estimate of the squared error is made a share of its sum, so that every depth counts alike; a cell
/// takes its largest over the instants deeper than deep_share of the deepest; and that share of the cells with the
/// largest is divided. No cell is ever larger than on the first mesh, which resolves the contact.
/// @param coarser  mesh of the level before; unused on level 0 and in the fixed family
/// @throws std::runtime_error when the store has neither, MeshTooLarge
template <int dim>
[[nodiscard]] Discretisation<dim> sequence_mesh(const scene::Scene& scene, const ModelChoice& choice, int level,
                                                const Discretisation<dim>* coarser, const Store& store);

/// How much finer than the first each level is, for force_band() and point_band(): refinement(), or with
/// reference.adaptive_share a power of the ratio of unknowns, since their meshes have no common ratio of cell sizes.
[[nodiscard]] std::vector<double> fineness(const scene::Scene& scene, int dim, const std::vector<int>& unknowns);

/// How the force's uncertainty is found from them. With reference.adaptive_share the instants are those deeper than
/// deep_share of the deepest, for which the cells are chosen, and in space the error may fall as fast as N^-0.8 with
/// the number N of unknowns. Most fall faster, but not those at the edge of a support (reports/reference.md).
[[nodiscard]] BandRule force_rule(const scene::Scene& scene, int dim,
                                  const std::vector<scene::ReferenceInstant>& instants);

/// About how many times the cells of the coarser mesh a level has, with reference.adaptive_share.
[[nodiscard]] double adaptive_growth(const scene::Scene& scene, int dim);

}  // namespace touchstone::reference
