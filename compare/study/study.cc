#include "compare/study/study.h"

#include "reference/solver.h"
#include "scene/base/build_info.h"
#include "scene/base/files.h"
#include "scene/base/hash.h"
#include "scene/base/json_text.h"
#include "scene/input/scene_io.h"
#include "scene/mesh/mesh_file.h"
#include "scene/model/first_contact.h"
#include "scene/output/results.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <set>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;

/// Increased if the manifest changes so that an older one would be misread.
constexpr int manifest_format = 1;

/// The limit of most sites for one job array (Slurm's default MaxArraySize is 1001).
constexpr int most_array_tasks = 1000;

Json pairs(const std::vector<std::pair<std::string, std::string>>& list) {
  Json json = Json::object();
  for (const auto& [key, value] : list) json[key] = value;
  return json;
}

std::vector<std::pair<std::string, std::string>> pairs(const Json& json) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const auto& [key, value] : json.items()) list.emplace_back(key, value.get<std::string>());
  return list;
}

/// Quotes a path for a shell.
std::string quoted(const std::filesystem::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string batch_script(const StudyManifest& manifest, const std::filesystem::path& program,
                         const std::filesystem::path& store) {
  const std::filesystem::path folder = std::filesystem::absolute(manifest.folder).lexically_normal();
  const int tasks = std::min(static_cast<int>(manifest.cases.size()), most_array_tasks);
  return fmt::format(R"(#!/bin/bash
# {title}
# {cases} cases, one array task for each{shared}. Read, edit, then: sbatch {script}
# A task that is killed, or runs out of time, is simply submitted again: it goes on where it was.
#SBATCH --job-name={name}
#SBATCH --array=1-{tasks}
# "%20" behind the range limits how many run at a time.
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --mem=8G
#SBATCH --time=04:00:00
#SBATCH --output={folder}/logs/%A_%a.txt
# A minute before the end the solver is told to stop; finished load steps are kept.
#SBATCH --signal=B:TERM@60

program={program}
study={quoted_folder}
store={store}   # of the reference, one for all tasks and studies

export OMP_NUM_THREADS="${{SLURM_CPUS_PER_TASK:-1}}"
# A case too large for one process: raise --ntasks and put this before "$program":
#   mpirun -np "$SLURM_NTASKS"
exec "$program" study run "$study" --index "$SLURM_ARRAY_TASK_ID" --step {tasks} --store "$store"
)",
                     fmt::arg("title", manifest.title.empty() ? manifest.name : manifest.title),
                     fmt::arg("cases", manifest.cases.size()),
                     fmt::arg("shared", tasks < static_cast<int>(manifest.cases.size())
                                            ? fmt::format(" or, from task number in steps of {}, several", tasks)
                                            : ""),
                     fmt::arg("script", quoted(folder / "array.sbatch")), fmt::arg("name", manifest.name),
                     fmt::arg("tasks", tasks), fmt::arg("folder", folder.string()),
                     fmt::arg("program", quoted(program)), fmt::arg("quoted_folder", quoted(folder)),
                     fmt::arg("store", quoted(std::filesystem::absolute(store).lexically_normal())));
}

/// Copies a mesh tool into the study's folder, which is then complete and can be moved.
/// @returns its path from a scene there
std::string keep_tool(const scene::Tool& tool, const std::filesystem::path& folder) {
  const std::string& content = *scene::content_of_file(tool.mesh);
  const std::string name = scene::hash_text(content) + "-" + scene::kept_tool_name(tool);
  std::filesystem::create_directories(folder / "tools");
  if (!std::filesystem::exists(folder / "tools" / name)) scene::write_file(folder / "tools" / name, content);
  return "../tools/" + name;
}

}  // namespace

std::string case_id(const std::string& run, const scene::Scene& scene) {
  return scene::hash_text(run + '\n' + scene::scene_hash(scene));
}

StudyManifest expand(const Study& study, const std::filesystem::path& folder, const std::filesystem::path& program,
                     const std::filesystem::path& store) {
  std::vector<scene::Scene> scenes = load_cases(study, [&](const scene::Scene& scene) {
    return study.run == "fast" ? std::vector<scene::Fault>{} : reference::unsupported(scene);
  });
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  for (const char* name : {"scenes", "results", "logs"}) std::filesystem::create_directories(folder / name);

  StudyManifest manifest{folder, study.name, study.title, study.run, study.axes, {}};
  std::set<std::string> ids;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    scene::Scene& scene = scenes[k];
    const StudyCase& one = study.cases[k];
    scene.title = (scene.title.empty() ? scene.name : scene.title) + ": " + one.name;
    if (scene.tool.mesh) scene.tool.file = keep_tool(scene.tool, folder);
    const std::string text = scene::resolved_toml(scene);
    ManifestCase entry{static_cast<int>(manifest.cases.size()) + 1,
                       case_id(study.run, scene::parse_scene(text, folder / "scenes" / "case.toml")),
                       one.name,
                       one.along,
                       {}};
    if (!ids.insert(entry.id).second) continue;
    entry.warning = scene::no_contact_warning(scene);
    for (const scene::Setting& setting : one.settings) entry.settings.emplace_back(setting.key, setting.value);
    scene::write_file(manifest.scene_file(entry), text);
    manifest.cases.push_back(std::move(entry));
  }

  Json json = {{"format", manifest_format},
               {"kind", "sweep"},
               {"name", manifest.name},
               {"title", manifest.title},
               {"run", manifest.run},
               {"axes", manifest.axes},
               {"version", scene::build_info.version},
               {"commit", scene::build_info.commit}};
  for (const ManifestCase& one : manifest.cases) {
    json["cases"].push_back({{"index", one.index},
                             {"id", one.id},
                             {"name", one.name},
                             {"scene", "scenes/" + one.id + ".toml"},
                             {"result", "results/" + one.id},
                             {"along", pairs(one.along)},
                             {"set", pairs(one.settings)}});
  }
  scene::write_file(folder / "array.sbatch", batch_script(manifest, program, store));
  scene::write_file(folder / "manifest.json", scene::json_text(json));
  return manifest;
}

StudyManifest read_manifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  const auto refuse = [&](const std::string& what) {
    throw scene::InputError({{file.string(), 0, 0, what + "; expected what \"touchstone study expand\" writes"}});
  };
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) refuse("cannot read it");
  StudyManifest manifest;
  try {
    const Json json = Json::parse(*text);
    if (json.at("format") != manifest_format || json.at("kind") != "sweep") refuse("another format or kind of study");
    manifest = {folder, json.at("name"), json.at("title"), json.at("run"), json.at("axes"), {}};
    for (const Json& one : json.at("cases")) {
      manifest.cases.push_back(
          {one.at("index"), one.at("id"), one.at("name"), pairs(one.at("along")), pairs(one.at("set"))});
    }
  } catch (const Json::exception& error) {
    refuse(error.what());
  }
  return manifest;
}

std::optional<StudyPlace> place_in_study(const std::filesystem::path& result_folder) {
  std::filesystem::path folder = std::filesystem::weakly_canonical(result_folder);
  if (!folder.has_filename()) folder = folder.parent_path();
  const std::filesystem::path study = folder.parent_path().parent_path();
  if (folder.parent_path().filename() != "results" || !std::filesystem::exists(study / "manifest.json")) return {};
  try {
    for (const ManifestCase& one : read_manifest(study).cases) {
      if (folder.filename() == one.id) return StudyPlace{study, one.index, one.name};
    }
  } catch (const scene::InputError&) {
    // Another kind of manifest: the folder only has a name as in a study.
  }
  return {};
}

}  // namespace touchstone::compare
