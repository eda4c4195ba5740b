// One solved instant as the bytes that the store keeps.
#pragma once

#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace touchstone::reference {

/// What is kept of one solved instant besides its state.
struct Step {
  Observation seen;
  int unknowns = 0;
  int newton_iterations = 0;
  int halvings = 0;
  int indefinite = 0;
  double wall_s = 0.0, cpu_s = 0.0;
  std::string linear_solver;
};

template <int dim>
[[nodiscard]] std::string to_record(const Solved<dim>& solved, const Step& step);

/// @returns nothing when the record does not belong to this mesh
template <int dim>
[[nodiscard]] std::optional<std::pair<Solved<dim>, Step>> from_record(std::string_view record,
                                                                      const Discretisation<dim>& mesh);

}  // namespace touchstone::reference
