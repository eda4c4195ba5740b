// `touchstone gate`: the accuracy gates.
#pragma once

#include "compare/gate/gate.h"
#include "fast/command/command.h"

#include <filesystem>

namespace touchstone::compare {

struct GateOptions {
  GateNames names{};  ///< empty: all
  std::filesystem::path folder = "tests/gates";
  std::filesystem::path out = "out/gate";
  std::filesystem::path junit{};  ///< empty: none
  std::string base{};             ///< commit whose limits may not be widened; empty: none
  bool prove = false;
  bool regenerate = false;
  bool accept = false;
  bool list = false;
  bool quiet = false;
  ReferenceOptions reference{};  ///< for regenerate
};

/// @returns exit code: answer_is_no when a gate is red, or not proved
int gate(const GateOptions& options, const std::string& command);

void add_gate_verb(fast::Command& program, GateOptions& options);

}  // namespace touchstone::compare
