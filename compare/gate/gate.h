// Accuracy gates: limits on figures of shipped scenes, checked against committed reference data, closed forms and the
// last accepted values.
//
//   GATES/<file>.toml              the gates of one scene, see scene/gate_file.h
//   GATES/waivers.toml             for limits wider than those of another commit
//   GATES/reference/<name>/        committed reference data, see stored_reference.h
//   GATES/reference/accepted.json  the last accepted value of every drift gate
#pragma once

#include "compare/gate/gate_figures.h"
#include "compare/input/gate_file.h"
#include "compare/solve/reference_run.h"
#include "scene/output/results.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// A drift gate's value as it was accepted.
struct AcceptedValue {
  double value = 0.0;
  std::string unit;
  std::string scene_hash;  ///< scene::scene_hash of the scene it is of
};

/// All of a folder of gates.
struct GateFolder {
  std::filesystem::path folder;
  std::vector<GateFile> files;  ///< by name
  std::vector<GateWaiver> waivers;
  std::map<std::string, AcceptedValue> accepted;  ///< by "file.gate"
  std::vector<std::string> unused;                ///< reference data and accepted values that no gate asks for
  std::vector<ModelList> models;                  ///< that the files may name one of
};

/// @throws scene::InputError with the faults of all files, and where there is no gate at all
[[nodiscard]] GateFolder load_gates(const std::filesystem::path& folder,
                                    const std::vector<ModelList>& models = registered_models());

/// What one gate found.
struct GateRecord {
  std::string file;
  Gate gate;
  std::optional<double> value, uncertainty, accepted;
  std::string failure;  ///< why it is red apart from its number: none, stale data, a wider limit; else empty

  /// "file.gate"
  [[nodiscard]] std::string name() const { return file + "." + gate.name; }
  /// What the limit holds: |value| + uncertainty of a truth gate, |value - accepted| of a drift gate; NaN without.
  [[nodiscard]] double held() const noexcept;
  /// Limit less held().
  [[nodiscard]] double margin() const noexcept { return gate.limit - held(); }
  /// Is the number within the limit, and finite?
  [[nodiscard]] bool within() const noexcept { return margin() >= 0.0; }
  [[nodiscard]] bool passes() const noexcept { return failure.empty() && within(); }
};

/// Holds one gate against figures. A key that is absent or no number, another unit, a truth without an uncertainty and
/// a drift without an accepted value of this scene are red.
/// @param accepted    of this gate, or null
/// @param scene_hash  of the file's own scene
[[nodiscard]] GateRecord judge(const std::string& file, const Gate& gate, const scene::Figures& figures,
                               const AcceptedValue* accepted, const std::string& scene_hash);

/// Which gates are asked for: names of files or "file.gate"; none: all.
using GateNames = std::vector<std::string>;

/// @throws scene::InputError for a name that is no gate, before any work
void require_known(const GateFolder& folder, const GateNames& names);

/// Runs the files asked for and holds their gates. A scene that gives no answer makes its gates red.
/// @param working  called with what is run; may be empty
[[nodiscard]] std::vector<GateRecord> run_gates(const GateFolder& folder, const GateNames& names,
                                                const std::function<void(const std::string&)>& working = {});

/// A gate under the change that must turn it red.
struct GateProof {
  GateRecord changed;
  std::string failure;  ///< why nothing is proved; empty when the change alone turned the gate red

  [[nodiscard]] bool holds() const noexcept { return failure.empty(); }
};

/// Applies every gate's own change. Only a number beyond its limit proves anything: no answer and no number do not, and
/// a gate that is red without the change does not.
/// @param records  of run_gates
[[nodiscard]] std::vector<GateProof> prove_gates(const GateFolder& folder, const std::vector<GateRecord>& records,
                                                 const std::function<void(const std::string&)>& working = {});

/// Solves the reference of the files asked for that name reference data, and writes it.
/// @returns lines on what changed
[[nodiscard]] std::vector<std::string> regenerate(const GateFolder& folder, const GateNames& names,
                                                  const ReferenceOptions& options, bool quiet);

/// Writes the values found as the accepted ones of the drift gates among the records.
/// @returns lines on what changed; @throws scene::InputError when one has no finite value, before writing
[[nodiscard]] std::vector<std::string> accept(const GateFolder& folder, const std::vector<GateRecord>& records);

}  // namespace touchstone::compare
