// `live`, the same in both executables, except for the page, which only the full one can write.
#pragma once

#include "fast/command/command_line.h"
#include "fast/live/live.h"

#include <filesystem>
#include <functional>
#include <string>

namespace touchstone::live {

/// Writes a page about a run into its result folder. @returns the page's file
using WritePage = std::function<std::filesystem::path(const std::filesystem::path& folder, const scene::Scene& scene,
                                                      const LiveOptions& options, const LiveResult& result,
                                                      const scene::Manifest& manifest)>;

/// Loads the scene, runs the device until it is over or Ctrl-C, leaves live.csv, summary.json and manifest.json.
/// @param command for the manifest, such as "touchstone live"
/// @param page    called when all else is written; empty: no page
/// @returns done; answer_is_no where a replay differs from its log; interrupted after Ctrl-C, with all written
/// @throws scene::InputError for bad input
int live_verb(const fast::VerbOptions& options, const LiveOptions& live, const std::string& command,
              const WritePage& page);

/// Adds the command; its variables must outlive Program::run.
void add_live_verb(fast::Command& program, fast::VerbOptions& options, LiveOptions& live, const WritePage& page = {});

}  // namespace touchstone::live
