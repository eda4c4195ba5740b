// The offline reference: finite-strain contact of a rigid tool with an elastic body, with an
// uncertainty on every number. This header is free of deal.II; see the .cc files for the method.
#pragma once

#include "reference/mesh/boundary_surface.h"
#include "scene/base/error.h"
#include "scene/model/plan.h"
#include "scene/model/record.h"
#include "scene/model/scene.h"

#include <atomic>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchstone::reference {

/// How far a solve is: a Newton iteration, a finished load step, or something worth a word.
struct Progress {
  int level = 0;                  ///< 1-based mesh
  int levels = 0;                 ///< meshes asked for, or that are needed at least
  bool at_least = false;          ///< there may be more than `levels`: as many as the asked error takes
  int instant = 0, instants = 0;  ///< 1-based track instant being solved
  double depth_m = 0.0;
  int newton = 0;             ///< iteration within the load step
  double residual_rel = 0.0;  ///< Newton residual over its scale
  int unknowns = 0;
  double seconds_left =
      -1.0;  ///< estimate for this mesh, those up to `levels` and the sensitivities; negative: unknown
  bool step_finished = false;  ///< true once per finished load step, after it is on disk
  bool event = false;          ///< worth a line in a log: a mesh or a sensitivity begins, or nothing had to be solved
  std::string note{};          ///< "load step halved", "begins", "from the store"; usually empty
};

struct Options {
  std::filesystem::path store;                    ///< folder of content-addressed results; made when missing
  std::function<void(const Progress&)> progress;  ///< may be empty
  const std::atomic<bool>* stop = nullptr;        ///< when it becomes true: throw Interrupted, losing no finished step
  /// Area that each rest point stands for in the norm of the shape's uncertainty; empty: all the same.
  std::vector<double> rest_area_m2{};
  /// Limits of a solve, on every mesh and sensitivity: none is begun that would exceed them by prediction, and what
  /// has been begun ends when the time is up, between two Newton iterations. What is in the store is read all the same.
  std::optional<double> memory_limit_bytes{};                      ///< of the process; absent: 80 % of the machine's
  double seconds_limit = std::numeric_limits<double>::infinity();  ///< of the whole call
};

/// What one mesh of the refinement sequence gave.
struct LevelRecord {
  double element_size_m = 0.0;  ///< under the tool
  int unknowns = 0;             ///< displacement unknowns
  int newton_iterations = 0;    ///< all load steps
  int steps_cut = 0;            ///< load steps halved on the way
  double wall_s = 0.0;          ///< when it was solved, also if it now comes from the store
  double cpu_s = 0.0;           ///< the same, of all threads
  std::vector<double> force_n;  ///< magnitude of the contact force per instant
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
  std::vector<scene::InstantRecord> instants;
  std::vector<std::vector<scene::Vec3>> region_middles_m;   ///< per instant, one for every region
  std::vector<double> force_uncertainty_n;                  ///< per instant, conservative half width
  std::vector<Eigen::VectorXd> displacement_uncertainty_m;  ///< per instant, per rest point
  std::optional<double> force_uncertainty_rel;      ///< largest band / |F| over the instants with a deep contact
  std::optional<double> shape_uncertainty_rel;      ///< band over displacement, both root mean square by area over all
                                                    ///< points and instants
  std::vector<double> residual_penetration_m;       ///< per instant, largest over contact nodes
  std::vector<double> between_nodes_penetration_m;  ///< per instant, largest over face quadrature points
  std::vector<double> equilibrium_rel;              ///< per instant, |contact + support| / |contact|
  std::vector<double> volume_change_rel;            ///< per instant, of the body
  std::vector<LevelRecord> levels;
  std::vector<Sensitivity> sensitivities;  ///< all, or empty: with fewer than three levels, or for want of time
  Refinement refinement;
  BoundarySurface deepest_surface;  ///< of the finest mesh, at the first of the deepest instants
  bool from_store = false;          ///< nothing had to be solved
};

/// A load step that could not converge even after cutting; names the instant, the contact region and
/// place, the residual, what to try.
class NotConverged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A limit of Options left no mesh finished. Says which, what was finished, and how long the rest probably takes.
class LimitReached : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Options::stop was raised; every finished step is in the store.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What this solver will model for the scene. Cheap: nothing is solved.
[[nodiscard]] scene::Plan plan(const scene::Scene& scene);

/// What of the scene this solver cannot do; empty when it can. solve() throws InputError with these.
[[nodiscard]] std::vector<scene::Fault> unsupported(const scene::Scene& scene);

/// Content address of the scene's reference result: everything that changes the answer, nothing else.
[[nodiscard]] std::string content_key(const scene::Scene& scene);

/// Solves, resumes or reads back.
/// @param rest_points_m  points of the rest surface at which displacement is wanted, 3 x n, world frame
/// @throws InputError, NotConverged, LimitReached, Interrupted, std::filesystem::filesystem_error
[[nodiscard]] Result solve(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m, const Options& options);

}  // namespace touchstone::reference
