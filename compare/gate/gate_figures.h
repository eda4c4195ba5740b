// What gates hold: figures of a gate file's scene, computed anew.
#pragma once

#include "compare/input/gate_file.h"
#include "compare/model/registry.h"
#include "scene/base/error.h"
#include "scene/model/scene.h"
#include "scene/output/results.h"
#include "scene/shape/surface.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// Figures of a gate file's scene, computed anew. The fast model's, or another's in its place, are those of `touchstone
/// compare` against the committed reference data, where the file names them, else those of `touchstone fast` and
/// force.peak_fast_n. The reference's, always solved from nothing, are those of `touchstone reference`,
/// reference.force_peak_n, and
///   hertz.force_rel        force over Hertz's closed form - 1 at the deepest instant, where that applies: a ball on a
///                          flat top in small strain; with its uncertainty
///   resolved.force_rel, resolved.shape_rel_l2
///                          its distance from the committed reference data, relative to the largest force and, by
///                          area over points and instants, to the displacement
/// A second code's, also solved from nothing, are how far the reference is from CalculiX on the scene's exported deck
/// (level 1, Poisson's ratio of at most 0.49), at the deepest instant and with the reference's uncertainty:
///   second_code.force_rel    force over CalculiX's - 1
///   second_code.surface_rel  largest distance of a node of the surface over CalculiX's largest displacement
/// What is compared with stays that of the file's own scene.
/// @param change  values over the file's own, as for --set
/// @param models  that the file may name one of
/// @throws scene::InputError, UnusableReference, Unavailable, reference::NotConverged, std::logic_error when `change`
///         makes the answer incomparable
[[nodiscard]] scene::Figures gate_figures(const GateFile& file, const std::vector<std::string>& change,
                                          const std::vector<ModelList>& models);

/// Why a file's scene cannot give its figures; none when it can. @throws scene::InputError for a model that is none
[[nodiscard]] std::vector<scene::Fault> unsupported_by_gate(const GateFile& file, const scene::Scene& scene,
                                                            const std::vector<ModelList>& models);

/// A gate file's scene under a change.
/// @throws scene::InputError
[[nodiscard]] scene::Scene scene_of(const GateFile& file, const std::vector<std::string>& change = {});

/// The rest points of committed reference data.
[[nodiscard]] scene::Surface rest_surface(const scene::Scene& scene);

/// Largest force of a track, NaN when one is NaN [N].
[[nodiscard]] double peak_n(const scene::Instants& instants);

}  // namespace touchstone::compare
