// Limits may become narrower; a wider one needs a waiver with a name and a date.
#pragma once

#include "compare/gate/gate.h"

namespace touchstone::compare {

/// Gates as they are at another commit.
struct BaseGates {
  std::string commit;  ///< as it was named
  std::vector<GateFile> files;
};

/// Asks git for the folder's gate files at a commit. Without the folder there, none.
/// @throws scene::InputError when there is no such commit or git, or a file there cannot be read
[[nodiscard]] BaseGates base_gates(const std::filesystem::path& folder, const std::string& commit);

/// Makes a gate red whose limit is wider than the base's, or that now holds another quantity, kind, unit or run, unless
/// a waiver holds for it.
/// @param base   or null: only the waivers are looked at
/// @param today  a waiver holds to the end of its last day, UTC
/// @returns what is wrong beside single gates: gates of the base that are gone, waivers that have expired or that are
///          for no gate
[[nodiscard]] std::vector<std::string> hold_limits(const GateFolder& folder, const BaseGates* base,
                                                   std::chrono::year_month_day today, std::vector<GateRecord>& records);

/// Of the clock, UTC.
[[nodiscard]] std::chrono::year_month_day today();

}  // namespace touchstone::compare
