// What solving a mesh takes, estimated before it is solved: Newton iterations, time, memory. One model serves
// `touchstone plan`, the limits of a run and the time left in its progress.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <string>

namespace touchstone::reference {

/// What a mesh asks of the solver.
struct MeshWork {
  int dim = 3;
  double unknowns = 0.0;  ///< displacement unknowns
  int load_steps = 0;     ///< instants in contact
  bool friction = false;
};

struct Cost {
  double newton_iterations = 0.0;
  double seconds = 0.0;       ///< wall time, see expected_cost()
  double memory_bytes = 0.0;  ///< of the whole process at its largest
};

/// Newton iterations per load step, times assembly (proportional to the unknowns) and factorisation (a power of them)
/// per iteration. The constants are fitted to the shipped scenes on two cores of an AMD EPYC (Zen 4) at 2.6 GHz with
/// nothing else to do, see reports/reference.md; another machine is faster or slower by a factor that a run finds out,
/// see Pace.
/// @param threads  the solver's
[[nodiscard]] Cost expected_cost(const MeshWork& work, int threads);

/// Memory that the solve of a mesh takes, of the whole process at its largest [bytes]: fitted to the shipped scenes,
/// most of it the factor and the work space of its making.
[[nodiscard]] double expected_memory_bytes(int dim, double unknowns);

/// How much slower than expected_cost() a run is, from what it has finished: the ratio of the sums, which begins at
/// one.
class Pace {
 public:
  /// @param expected_s, measured_s  of a finished load step
  void finished(double expected_s, double measured_s) noexcept;
  [[nodiscard]] double factor() const noexcept;

 private:
  double expected_s_ = 0.0, measured_s_ = 0.0, largest_s_ = 0.0;
};

/// Displacement unknowns of a mesh, those at the support and on symmetry planes included.
template <int dim>
[[nodiscard]] double unknowns_of(const Discretisation<dim>& mesh) {
  return static_cast<double>(dim) * (mesh.node_count() - mesh.hanging_count());
}

/// "40 s", "12 min", "3.5 h".
[[nodiscard]] std::string duration_text(double seconds);

/// "0.4 GiB".
[[nodiscard]] std::string memory_text(double bytes);

}  // namespace touchstone::reference
