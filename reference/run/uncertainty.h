// How far the finest level may be from the exact answer of the model, from what refinement changed.
#pragma once

#include "scene/model/answer.h"
#include "scene/output/figures.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace touchstone::reference {

/// How force_band() judges meshes that an estimate refines; as it is, those of the fixed family.
struct BandRule {
  /// The error is taken for one of f^-p, with the p between 1 and this by which the differences of the last three
  /// levels fall, each the largest over the instant and its neighbours.
  double most_order = 1.0;
  /// Per instant, whether the meshes are refined for it; such a one takes no band from a neighbour that is not. Empty:
  /// all are.
  std::vector<bool> refined_for{};
};

/// Half width of the band per instant, for a quantity F0, F1, F2 on the last three levels, whose cells are 1 / f of a
/// common size:
///   b = 1.25 max over pairs j < k of |Fk - Fj| / (f2 / fj - f2 / fk),
/// the widest and those no closer than fk / fj = 1.4, then the largest over the instant and its two neighbours.
/// Why so: a contact force does not approach its limit from one side, because the contact's edge moves by whole nodes;
/// Richardson's extrapolation would be luck. Each quotient is the error of F2 when the error is of first order in the
/// cell size and the pair differs by no chance; quadratic cells do better. Several pairs guard against two levels
/// agreeing by chance, the neighbours against all doing so at one instant, and 1.25 is Roache's factor for three or
/// more grids (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413). It covers the mesh and nothing else: not the material
/// law.
/// @param levels  [level][instant], coarsest first
/// @param finer   f of each level
/// @returns NaN, for unknown, throughout with fewer than three levels
[[nodiscard]] std::vector<double> force_band(const std::vector<std::vector<double>>& levels,
                                             const std::vector<double>& finer, const BandRule& rule = {});

/// The same per point for a vector or a 3 x 3 matrix there, with the norm of the difference of two of them.
/// Quadratic cells do better than first order, but the far field is refined less than the contact.
/// @param levels  [level][instant], a column per point
/// @tparam rows  3 or 9
/// @returns per instant, per point
template <int rows>
[[nodiscard]] std::vector<Eigen::VectorXd> point_band(
    const std::vector<std::vector<Eigen::Matrix<double, rows, Eigen::Dynamic>>>& levels,
    const std::vector<double>& finer);

/// Figures "where the contact is deep" use the instants whose depth exceeds this share of the largest depth.
inline constexpr double deep_share = 0.1;

/// Below this depth a tool only grazes: round-off of the track decides whether it touches at all.
inline constexpr double grazing_depth_m = 1e-9;

/// Per instant: in contact, and deeper than deep_share of the deepest.
[[nodiscard]] std::vector<bool> deep_instants(const scene::Instants& instants);

/// Largest band / |F| over the deep instants; absent where nothing pushes.
[[nodiscard]] std::optional<double> force_uncertainty_rel(const std::vector<scene::ReferenceInstant>& instants);

/// sqrt(sum over instants and rest points of A b^2 / the same of A |u|^2); absent where nothing moves.
/// @param area_m2  A of each rest point; empty: equal
[[nodiscard]] std::optional<double> shape_uncertainty_rel(const std::vector<scene::ReferenceInstant>& instants,
                                                          const std::vector<double>& area_m2);

/// The areas as a vector, ones where there are none.
[[nodiscard]] Eigen::VectorXd areas_or_ones(const std::vector<double>& area_m2, Eigen::Index points);

}  // namespace touchstone::reference
