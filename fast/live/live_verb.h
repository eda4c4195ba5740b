// `live`, the same in both executables.
#pragma once

#include "fast/command_line.h"
#include "fast/live/live.h"

#include <string>

namespace touchstone::live {

/// Loads the scene, runs the device until it is over or Ctrl-C, leaves live.csv, summary.json and manifest.json.
/// @param command for the manifest, such as "touchstone live"
/// @returns done; answer_is_no where a replay differs from its log; interrupted after Ctrl-C, with all written
/// @throws scene::InputError for bad input
int live_verb(const fast::VerbOptions& options, const LiveOptions& live, const std::string& command);

/// Adds the verb with its options to a command line. `options`, `live` and `exit_code` must outlive the parse.
void add_live_verb(CLI::App& app, fast::VerbOptions& options, LiveOptions& live, int& exit_code);

}  // namespace touchstone::live
