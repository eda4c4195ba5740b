// What gates found, for the terminal, for programs and for CI.
#pragma once

#include "compare/gate/gate.h"

namespace touchstone::compare {

/// "The gate holds", "All 12 gates hold" or "1 of 2 gates is red".
[[nodiscard]] std::string gates_verdict(const std::vector<GateRecord>& records);

/// Why a gate that does not pass is red.
[[nodiscard]] std::string why_red(const GateRecord& record);

/// The table: gate, kind, value, what the limit holds, limit, margin, ok or RED; below it why a gate is red.
/// @param faults  of the folder, not of single gates
[[nodiscard]] std::string gates_text(const std::vector<GateRecord>& records, const std::vector<std::string>& faults);

/// The table: gate, change, what the limit holds with it, limit, red or NOT PROVED; below it why.
[[nodiscard]] std::string proofs_text(const std::vector<GateProof>& proofs);

/// Per gate `gate.<file>.<gate>.value|uncertainty|accepted|held|limit|margin|verdict`, and gate.count, gate.red,
/// gate.faults.
/// @param faults  beside single gates: of the folder and of proofs
[[nodiscard]] scene::Figures gate_report_figures(const std::vector<GateRecord>& records,
                                                 const std::vector<std::string>& faults);

/// JUnit's XML: a test case per gate with its numbers as properties, one more for the faults.
[[nodiscard]] std::string gates_junit(const std::vector<GateRecord>& records, const std::vector<std::string>& faults);

}  // namespace touchstone::compare
