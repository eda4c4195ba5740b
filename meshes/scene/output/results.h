// The result folder of every command, for people, ParaView, pandas and CI.
#pragma once

#include "scene/base/files.h"
#include "scene/base/stopwatch.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"
#include "scene/output/figures.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::scene {

/// One column of a table; the name ends in its unit.
struct Column {
  std::string name;
  std::vector<double> values;
};

/// Columns of one side: depth, force, torque, area per region by its id (region0_..., as many as occur), with friction
/// and sliding (0 or 1) where there is friction.
/// @param prefix put before every name, such as "fast_"; may be empty
[[nodiscard]] std::vector<Column> record_columns(const Instants& records, const std::string& prefix);

/// time_s and the tool's pose, which both sides share.
[[nodiscard]] std::vector<Column> track_columns(const Instants& records);

/// Comma-separated, one header line, numbers as short as they read back exactly; unknown is nan.
void write_csv(const std::filesystem::path& path, const std::vector<Column>& columns);

/// One flat JSON object, dotted key to number or text, plus "units" with the same keys. A number that is not finite is
/// null, and its text, the reason, is in "reasons" under the same key.
void write_summary(const std::filesystem::path& path, const Figures& figures);

/// A mesh tool's file as a copy of it is kept: "tool" with the file's ending. Empty for any other tool.
[[nodiscard]] std::string kept_tool_name(const Tool& tool);

/// Manifest as lines of name and value: scene hash, version, compiler, host, date, times.
struct Manifest {
  std::string command;
  std::string scene_hash;
  std::string title;                                         ///< of the scene, or its name
  std::string resolved_scene;                                ///< TOML with every value in force
  std::vector<std::pair<std::string, std::string>> entries;  ///< version, compiler, host, date, and what a command adds
  std::vector<StageTime> times;
  std::string tool_name = {};                          ///< of the mesh tool's copy beside the manifest; "" without one
  std::shared_ptr<const TriangleMesh> tool_mesh = {};  ///< whose file is copied
};

/// Entries known everywhere: version, commit, compiler, build, host, processors, date, a warning of a missed contact.
/// The resolved scene names the copy of a mesh tool, so that a result folder can be moved; the hash is of the scene.
[[nodiscard]] Manifest make_manifest(const Scene& scene, const std::string& command);

/// Writes it as JSON, and the mesh tool's copy beside it.
/// @throws std::filesystem::filesystem_error
void write_manifest(const std::filesystem::path& path, const Manifest& manifest);

/// Makes the folder, takes it for this process, and clears it of what killed runs left half-written. Or says in one
/// InputError why it cannot be written to, at once also where another process writes to it.
/// @returns what keeps others out, until its end
[[nodiscard]] FolderLock prepare_result_folder(const std::filesystem::path& folder);

}  // namespace touchstone::scene
