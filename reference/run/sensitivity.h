// Change of the answer by choices of the method that refinement does not affect.
#pragma once

#include "reference/contact/load_path.h"
#include "reference/run/cost.h"
#include "reference/run/model_choice.h"
#include "reference/run/options.h"
#include "reference/run/result.h"
#include "reference/run/store.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::reference {

/// A solved instant on the coarsest mesh, to be solved again with one choice changed.
template <int dim>
struct SensitivityCase {
  const scene::Scene& scene;
  const ModelChoice& choice;
  const Discretisation<dim>& mesh;
  const Eigen::Matrix3Xd& rest_points_m;
  const std::vector<double>& rest_area_m2;  ///< see Options
  const std::vector<double>& times_s;       ///< of the instants up to the one measured, which is the last
  const Solved<dim>& at;                    ///< the instant's solution
  const scene::Vec3& force_n;               ///< its contact force
  const Solved<dim>* before;                ///< the solution of the instant before, or nullptr
};

/// The part of a sensitivity that the uncertainty includes on a level, 0 the coarsest, as a multiple of it.
[[nodiscard]] double share_at(const Sensitivity& sensitivity, int level);

/// One of the sensitivities before it is measured.
struct SensitivityWork {
  std::string part;
  MeshWork work;
};

/// The work to measure those that the store does not have.
/// @param touching  number of instants in contact up to the one measured
/// @param store  nullptr: as if it were empty
template <int dim>
[[nodiscard]] std::vector<SensitivityWork> missing_sensitivities(const scene::Scene& scene, const ModelChoice& choice,
                                                                 const Discretisation<dim>& coarsest, int touching,
                                                                 const Store* store);

/// A solution with one choice changed, as the store keeps it, on its mesh.
template <int dim>
struct ChangedSolution {
  Discretisation<dim> mesh;
  Solved<dim> solved;
};
/// @param part  which choice; @returns nothing where the store does not have it
template <int dim>
[[nodiscard]] std::optional<ChangedSolution<dim>> stored_sensitivity(const scene::Scene& scene,
                                                                     const ModelChoice& choice,
                                                                     const Discretisation<dim>& coarsest,
                                                                     const Store& store, const std::string& part);

using SensitivityWatch = std::function<void(const std::string& part, int iteration)>;

/// One after another: the load step halved, with friction a quarter as long, the active set's contact parameter and
/// the numerical bulk modulus of the tangent ten times as large, the grid of a mesh tool's distance half as wide, cells
/// at inclusions half as large, and cells far from the contact half as large. Those that do not apply to the scene
/// are left out; the last one always applies. Solved once per scene: the store keeps them.
/// @param watch  called in every Newton iteration, which are none when all is in the store; may throw to stop
/// @throws NotConverged  naming the one that failed
template <int dim>
[[nodiscard]] std::vector<Sensitivity> sensitivities(const SensitivityCase<dim>& given, const Store& store,
                                                     const SensitivityWatch& watch);

}  // namespace touchstone::reference
