// Drawings as files for papers: SVG, and PDF of the same by librsvg where the build has it.
#pragma once

#include "compare/report/fast_drawings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Whether this build can write PDF.
[[nodiscard]] bool has_pdf() noexcept;

/// One page as large as the drawing at 96 px to the inch; vectors stay vectors, text stays text, fonts are embedded.
/// @param svg  a file's, see as_file()
/// @throws std::runtime_error when it is not SVG, std::logic_error without has_pdf()
[[nodiscard]] std::string pdf_of(const std::string& svg);

/// Writes `<name>.svg` and, where there is PDF, `<name>.pdf` of each into the folder, which need not exist.
/// @throws std::filesystem::filesystem_error
void write_plots(const std::filesystem::path& folder, const std::vector<Drawing>& drawings);

}  // namespace touchstone::compare
