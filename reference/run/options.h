// Inputs of a solve of the reference, its reports of progress, and the ways it can end without a result.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchstone::reference {

/// How far a solve is: a Newton iteration, a finished load step, or an event.
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
  bool event = false;          ///< for a log, too: a mesh or a sensitivity begins, or nothing had to be solved
  std::string note{};          ///< "load step halved", "begins", "from the store"; usually empty
};

struct Options {
  std::filesystem::path store;                    ///< folder of content-addressed results; made when missing
  std::function<void(const Progress&)> progress;  ///< may be empty
  const std::atomic<bool>* stop = nullptr;        ///< when it becomes true: throw Interrupted, losing no finished step
  /// Area assigned to each rest point in the norm of the shape's uncertainty; empty: all equal.
  std::vector<double> rest_area_m2{};
  /// Limits of a solve, on every mesh and sensitivity: none is begun that would exceed them by prediction, and what
  /// has been begun ends when the time is up, between two Newton iterations. What is in the store is read all the same.
  std::optional<double> memory_limit_bytes{};                      ///< of the process; absent: 80 % of the machine's
  double seconds_limit = std::numeric_limits<double>::infinity();  ///< of the whole call
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

}  // namespace touchstone::reference
