// What gates found, as a page.
#pragma once

#include "compare/gate/gate.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// The page as well-formed XHTML: do all hold, what is red and why, then a row per gate with what its limit holds as a
/// bar, its limit and its margin, and the change that turns it red.
/// @param faults  beside single gates: of the folder and of proofs
/// @param proofs  empty when nothing was to be proved
/// @param out     folder of the page, for links to the gate files
[[nodiscard]] std::string gate_page_html(const GateFolder& folder, const std::vector<GateRecord>& records,
                                         const std::vector<std::string>& faults, const std::vector<GateProof>& proofs,
                                         const scene::Manifest& manifest, const std::filesystem::path& out);

}  // namespace touchstone::compare
