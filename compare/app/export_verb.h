// `touchstone export`: the scene as a deck for a second finite element code, and the results of that code.
#pragma once

#include "compare/solve/reference_run.h"
#include "fast/command/command_line.h"

#include <optional>

namespace touchstone::compare {

struct ExportOptions {
  int mesh = 1;                                        ///< of the reference's, 1 the coarsest
  std::optional<double> contact_stiffness_pa_per_m{};  ///< see reference::DeckOptions
  bool run = false;                                    ///< run CalculiX on it, solve the reference, and print both
  int time_to_error = 0;  ///< instead: on this many meshes, what a force error costs with either
};

/// Writes the deck and, when asked, curve.csv with the forces of both codes, or time-to-error.csv and .svg.
/// @returns exit code; @throws scene::InputError for bad input
int export_deck(const fast::VerbOptions& options, const ExportOptions& export_options,
                const ReferenceOptions& reference);

/// Adds the command; its variables must outlive Program::run.
void add_export_verb(fast::Command& program, fast::VerbOptions& options, ExportOptions& export_options,
                     ReferenceOptions& reference);

}  // namespace touchstone::compare
