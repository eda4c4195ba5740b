// What a solve of the reference leaves.
#pragma once

#include "reference/mesh/boundary_surface.h"
#include "scene/model/answer.h"

#include <optional>
#include <string>
#include <vector>

namespace touchstone::reference {

/// What one mesh of the refinement sequence gave.
struct LevelRecord {
  double element_size_m = 0.0;                            ///< under the tool; of adaptive meshes the smallest
  int unknowns = 0;                                       ///< displacement unknowns
  int newton_iterations = 0;                              ///< all load steps
  int steps_cut = 0;                                      ///< load steps halved on the way
  double wall_s = 0.0;                                    ///< when it was solved, also if it now comes from the store
  double cpu_s = 0.0;                                     ///< the same, of all threads
  std::vector<double> force_n;                            ///< magnitude of the contact force per instant
  std::vector<double> pressure_peak_pa = {};              ///< largest contact pressure at a node per instant
  std::vector<Eigen::Vector2d> contact_half_axes_m = {};  ///< per instant, see ReferenceInstant
};

/// How far a sensitivity measured on the coarsest level holds on the finer ones.
enum class Carries {
  wholly,         ///< refinement does not touch it
  first_order,    ///< nor this, of which a quarter as much would be left after the change
  far_field,      ///< it shrinks with the far field's cells
  in_the_levels,  ///< the differences between the levels show it already
};

/// What one choice of the method changes on the coarsest level at the deepest instant.
struct Sensitivity {
  std::string part;                       ///< "far_field"
  std::string change;                     ///< "cells half as large"
  double force_rel = 0.0;                 ///< |F' - F| / |F|
  double shape_rel = 0.0;                 ///< sqrt(sum A |u' - u|^2 / sum A |u|^2) over the rest points
  Eigen::VectorXd displacement_change_m;  ///< |u' - u| per rest point
  Carries carries = Carries::wholly;
};

/// What kept a reference from being refined further.
enum class EndedBy { done, time, memory, convergence, sensitivity };

/// How far the refinement came.
struct Refinement {
  double error_asked = 0.0;  ///< of force and shape, relative; 0: the scene asks for a number of levels
  bool reached = false;      ///< both uncertainties are at most that
  EndedBy ended_by = EndedBy::done;
  std::string why_ended;  ///< never empty: "there is no mesh 4: it would take about 31 GiB of memory, more than ..."
};

/// Answer for one scene; `instants` is the finest level's.
struct Result {
  std::string model;          ///< "quarter 3D u-p finite strain"
  std::string key;            ///< content address in the store
  std::string linear_solver;  ///< with the BLAS it ran on
  std::vector<scene::ReferenceInstant> instants;
  std::optional<double> force_uncertainty_rel;  ///< largest band / |F| over the instants with a deep contact
  std::optional<double> shape_uncertainty_rel;  ///< band over displacement, both root mean square by area over all
                                                ///< points and instants
  std::vector<LevelRecord> levels;
  std::vector<Sensitivity> sensitivities;  ///< all, or empty: with fewer than three levels, or for want of time
  Refinement refinement;
  BoundarySurface deepest_surface;  ///< of the finest mesh, at the first of the deepest instants
  bool from_store = false;          ///< nothing had to be solved
};

}  // namespace touchstone::reference
