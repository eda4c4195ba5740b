#pragma once

#include <string>

namespace touchstone {

/// The project's folder, where a test finds the shipped scenes, parameters and reports.
[[nodiscard]] std::string source_folder();

}  // namespace touchstone
