// `touchstone view`: a window on a result folder, or a picture of it.
#pragma once

#include "fast/command/command.h"

#include <filesystem>

namespace touchstone::compare {

struct ViewOptions {
  std::filesystem::path folder;
  std::filesystem::path screenshot;  ///< empty: a window
  int instant = 0;                   ///< from 1; 0: the deepest
  std::string colour, side;          ///< empty: the first there is
};

/// @returns exit code; @throws scene::InputError for a folder that is no result, and without a display
int view_result(const ViewOptions& options);

/// Adds the command; its variables must outlive Program::run.
fast::Command add_view_verb(fast::Command& program, ViewOptions& options);

}  // namespace touchstone::compare
