// A study as a folder of independent cases, which any number of processes on any number of hosts may run:
//
//   manifest.json        what the study is and its cases, numbered from 1
//   scenes/<id>.toml     the resolved scene of each case; `id` is its content's address, so equal cases are one
//   tools/               the mesh tools of those scenes
//   results/<id>/        the result folder of each case, with what study_run.h keeps of how it went
//   array.sbatch         a Slurm script to read and edit
//   summary.csv|json|md  the table over all cases that study_table.h makes
//   report.html          the same on a page, with the errors drawn over what varies
//
// Expanding again, with more values, keeps the results that are there.
#pragma once

#include "compare/input/study_file.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::compare {

struct ManifestCase {
  int index = 0;  ///< from 1
  std::string id;
  std::string name;
  std::vector<std::pair<std::string, std::string>> along;     ///< axis and label
  std::vector<std::pair<std::string, std::string>> settings;  ///< key and value as TOML
  std::string warning = {};  ///< of a track without contact, as expand() found it; not in the manifest's file
};

struct StudyManifest {
  std::filesystem::path folder;  ///< where it was read
  std::string name, title, run;
  std::vector<std::string> axes;
  std::vector<ManifestCase> cases;

  [[nodiscard]] std::filesystem::path scene_file(const ManifestCase& one) const {
    return folder / "scenes" / (one.id + ".toml");
  }
  [[nodiscard]] std::filesystem::path result_folder(const ManifestCase& one) const {
    return folder / "results" / one.id;
  }
};

/// Address of a case: of what runs and the scene it runs on.
[[nodiscard]] std::string case_id(const std::string& run, const scene::Scene& scene);

/// Writes the study's folder; cases with the same content become one.
/// @param program  the executable, for the batch script
/// @param store    of the reference, for the batch script
/// @throws scene::InputError with what is wrong in any case, before anything is written,
///         std::filesystem::filesystem_error
StudyManifest expand(const Study& study, const std::filesystem::path& folder, const std::filesystem::path& program,
                     const std::filesystem::path& store);

/// The position of a result folder in its study.
struct StudyPlace {
  std::filesystem::path study;  ///< the study's folder, without symbolic links
  int index = 0;                ///< of the case, from 1
  std::string name;             ///< of the case
};
/// Nothing for a folder that is no case's of a study around it.
[[nodiscard]] std::optional<StudyPlace> place_in_study(const std::filesystem::path& result_folder);

/// @throws scene::InputError when there is none or it cannot be read
[[nodiscard]] StudyManifest read_manifest(const std::filesystem::path& folder);

}  // namespace touchstone::compare
