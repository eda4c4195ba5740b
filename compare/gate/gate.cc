#include "compare/gate/gate.h"

#include "compare/errors/figures.h"
#include "compare/gate/stored_reference.h"
#include "scene/base/json_text.h"
#include "scene/base/nearest_name.h"
#include "scene/base/text.h"
#include "scene/input/scene_io.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;
using std::filesystem::path;

constexpr const char* waivers_name = "waivers.toml";

path data_folder(const path& gates) { return gates / "reference"; }
path accepted_file(const path& gates) { return data_folder(gates) / "accepted.json"; }

std::map<std::string, AcceptedValue> read_accepted(const path& file) {
  std::map<std::string, AcceptedValue> accepted;
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) return accepted;
  try {
    const Json json = Json::parse(*text);
    for (const auto& [name, entry] : json.items()) {
      accepted[name] = {entry.at("value"), entry.at("unit"), entry.at("scene_hash")};
    }
  } catch (const Json::exception&) {
    throw scene::InputError({{file.string(), 0, 0,
                              "is not JSON with value, unit and scene_hash of each gate; expected what \"touchstone "
                              "gate --accept\" writes"}});
  }
  return accepted;
}

void write_accepted(const path& file, const std::map<std::string, AcceptedValue>& accepted) {
  Json json = Json::object();
  for (const auto& [name, entry] : accepted) {
    json[name] = {{"value", entry.value}, {"unit", entry.unit}, {"scene_hash", entry.scene_hash}};
  }
  std::filesystem::create_directories(file.parent_path());
  scene::write_file(file, scene::json_text(json));
}

bool is_asked(const std::string& file, const std::string& gate, const GateNames& names) {
  return names.empty() ||
         std::ranges::any_of(names, [&](const std::string& name) { return name == file || name == file + "." + gate; });
}

bool is_asked(const GateFile& file, const GateNames& names) {
  return std::ranges::any_of(file.gates, [&](const Gate& g) { return is_asked(file.name, g.name, names); });
}

/// The figures of a run, or the reason why there are none.
struct Answer {
  scene::Figures figures;
  std::string failure;
};

Answer answer(const GateFile& file, const std::vector<std::string>& change, const std::vector<ModelList>& models) {
  try {
    return {gate_figures(file, change, models), ""};
  } catch (const reference::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    return {{}, error.what()};
  }
}

const AcceptedValue* accepted_of(const GateFolder& folder, const std::string& name) {
  const auto found = folder.accepted.find(name);
  return found == folder.accepted.end() ? nullptr : &found->second;
}

const GateFile& file_of(const GateFolder& folder, const std::string& name) {
  return *std::ranges::find(folder.files, name, &GateFile::name);
}

GateRecord judged(const GateFolder& folder, const GateFile& file, const Gate& gate, const Answer& answer,
                  const std::string& scene_hash) {
  if (!answer.failure.empty()) return {file.name, gate, {}, {}, {}, answer.failure};
  return judge(file.name, gate, answer.figures, accepted_of(folder, file.name + "." + gate.name), scene_hash);
}

/// A gate on a figure that its run does not have, or against missing reference data, is a fault of the gate file.
void require_answerable(const GateFile& file, const GateNames& names, const Answer& answer) {
  std::vector<scene::Fault> faults;
  for (const Gate& gate : file.gates) {
    if (!is_asked(file.name, gate.name, names) || !answer.failure.empty()) continue;
    if (scene::find_figure(answer.figures, gate.quantity) != nullptr) continue;
    std::vector<std::string> keys;
    for (const scene::Figure& figure : answer.figures) keys.push_back(figure.key);
    scene::Fault fault = gate.place;
    fault.message = "gate " + file.name + "." + gate.name + ": there is no figure " + scene::shortened(gate.quantity) +
                    "; expected a key of summary.json of a " + name_of(file.run) + " run" +
                    scene::did_you_mean(gate.quantity, keys);
    faults.push_back(std::move(fault));
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
}

void require_reference(const GateFile& file) {
  if (file.reference.empty() || std::filesystem::is_directory(file.reference)) return;
  scene::Fault fault = file.gates.front().place;
  fault.line = fault.column = 0;
  fault.message = "reference: there is no folder " + file.reference.string() +
                  "; expected reference data, which touchstone gate --regenerate " + file.name + " writes";
  throw scene::InputError({fault});
}

std::string hash_of(const GateFile& file) { return scene::scene_hash(scene_of(file)); }

bool is_drift(const GateFolder& folder, const std::string& name) {
  for (const GateFile& file : folder.files) {
    for (const Gate& gate : file.gates) {
      if (gate.kind == GateKind::drift && file.name + "." + gate.name == name) return true;
    }
  }
  return false;
}

/// Faults of the scenes of a file, its own and the changed ones, each reported with its gate.
std::vector<scene::Fault> scene_faults(const GateFile& file, const std::vector<ModelList>& models) {
  std::vector<scene::Fault> faults;
  const auto check = [&](const std::vector<std::string>& change, const std::string& whose) {
    std::vector<scene::Fault> found;
    try {
      found = unsupported_by_gate(file, scene_of(file, change), models);
    } catch (const scene::InputError& error) {
      found = error.faults();
    }
    for (scene::Fault& fault : found) {
      fault.message += " (" + whose + ")";
      faults.push_back(std::move(fault));
    }
  };
  check({}, "gates of " + file.name);
  if (!faults.empty()) return faults;
  for (const Gate& gate : file.gates) check(gate.red, "gate " + file.name + "." + gate.name + ", red");
  return faults;
}

void find_unused(GateFolder& folder) {
  std::set<path> wanted_folders;
  for (const GateFile& file : folder.files) {
    if (!file.reference.empty()) wanted_folders.insert(std::filesystem::weakly_canonical(file.reference));
  }
  if (std::filesystem::is_directory(data_folder(folder.folder))) {
    for (const auto& entry : std::filesystem::directory_iterator(data_folder(folder.folder))) {
      if (entry.path() == accepted_file(folder.folder)) continue;
      if (wanted_folders.contains(std::filesystem::weakly_canonical(entry.path()))) continue;
      folder.unused.push_back(entry.path().string() + ": no gate compares with it");
    }
  }
  for (const auto& [name, value] : folder.accepted) {
    if (!is_drift(folder, name)) {
      folder.unused.push_back(accepted_file(folder.folder).string() + ": no drift gate is called " + name);
    }
  }
  std::ranges::sort(folder.unused);
}

}  // namespace

double GateRecord::held() const noexcept {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (gate.kind == GateKind::drift) return std::abs(value.value_or(none) - accepted.value_or(none));
  return std::abs(value.value_or(none)) + uncertainty.value_or(none);
}

GateFolder load_gates(const path& folder, const std::vector<ModelList>& models) {
  GateFolder out;
  out.folder = folder;
  out.models = models;
  std::vector<scene::Fault> faults;
  const auto collecting = [&](const auto& load) {
    try {
      load();
    } catch (const scene::InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  };
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != ".toml" || entry.path().filename() == waivers_name) continue;
    collecting([&] { out.files.push_back(load_gate_file(entry.path())); });
  }
  for (const GateFile& file : out.files) {
    for (scene::Fault& fault : scene_faults(file, models)) faults.push_back(std::move(fault));
  }
  collecting([&] { out.waivers = load_gate_waivers(folder / waivers_name); });
  collecting([&] { out.accepted = read_accepted(accepted_file(folder)); });
  if (out.files.empty() && faults.empty()) {
    faults.push_back({folder.string(), 0, 0, "no gate files; expected a folder with some, such as tests/gates"});
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  std::ranges::sort(out.files, {}, &GateFile::name);
  find_unused(out);
  return out;
}

GateRecord judge(const std::string& file, const Gate& gate, const scene::Figures& figures,
                 const AcceptedValue* accepted, const std::string& scene_hash) {
  GateRecord record{file, gate, {}, {}, {}, ""};
  const scene::Figure* figure = scene::find_figure(figures, gate.quantity);
  if (figure == nullptr) {
    record.failure = "missing: there is no figure " + gate.quantity;
    return record;
  }
  if (!figure->text.empty()) {
    record.failure = gate.quantity + " is no number: " + figure->text;
    return record;
  }
  record.value = figure->number;
  if (figure->unit != gate.unit) {
    record.failure = fmt::format("unit \"{}\"; {} has \"{}\"", gate.unit, gate.quantity, figure->unit);
    return record;
  }
  if (gate.kind == GateKind::truth) {
    const std::string key = gate.quantity + std::string(uncertainty_suffix);
    const scene::Figure* uncertainty = scene::find_figure(figures, key);
    if (uncertainty == nullptr || !uncertainty->text.empty() || !std::isfinite(uncertainty->number)) {
      record.failure = "missing: " + gate.quantity + " has no uncertainty, so it is no error against a truth";
      return record;
    }
    record.uncertainty = uncertainty->number;
  } else if (accepted == nullptr) {
    record.failure = "missing: no accepted value; touchstone gate --accept " + record.name();
    return record;
  } else {
    record.accepted = accepted->value;
    if (accepted->scene_hash != scene_hash) {
      record.failure = "stale: the accepted value is of another scene; touchstone gate --accept " + record.name();
    } else if (accepted->unit != gate.unit) {
      record.failure = fmt::format("stale: the accepted value is in \"{}\"", accepted->unit);
    }
  }
  if (record.failure.empty() && !std::isfinite(record.held())) record.failure = "not finite";
  return record;
}

void require_known(const GateFolder& folder, const GateNames& names) {
  std::string known;
  std::set<std::string> all;
  for (const GateFile& file : folder.files) {
    all.insert(file.name);
    known += (known.empty() ? "" : ", ") + file.name;
    for (const Gate& gate : file.gates) all.insert(file.name + "." + gate.name);
  }
  for (const std::string& name : names) {
    if (!all.contains(name)) {
      throw scene::InputError("gate: no gate has the name \"" + name + "\"; expected FILE or FILE.GATE with FILE of " +
                              known + scene::did_you_mean(name, {all.begin(), all.end()}));
    }
  }
}

std::vector<GateRecord> run_gates(const GateFolder& folder, const GateNames& names,
                                  const std::function<void(const std::string&)>& working) {
  std::vector<GateRecord> records;
  for (const GateFile& file : folder.files) {
    if (!is_asked(file, names)) continue;
    require_reference(file);
    if (working) working(file.name);
    const Answer own = answer(file, {}, folder.models);
    require_answerable(file, names, own);
    const std::string hash = hash_of(file);
    for (const Gate& gate : file.gates) {
      if (is_asked(file.name, gate.name, names)) records.push_back(judged(folder, file, gate, own, hash));
    }
  }
  return records;
}

std::vector<GateProof> prove_gates(const GateFolder& folder, const std::vector<GateRecord>& records,
                                   const std::function<void(const std::string&)>& working) {
  std::map<std::pair<std::string, std::vector<std::string>>, Answer> answers;
  std::vector<GateProof> proofs;
  for (const GateRecord& record : records) {
    const GateFile& file = file_of(folder, record.file);
    const auto key = std::pair(record.file, record.gate.red);
    if (!answers.contains(key)) {
      if (working) working(record.file + " with " + fmt::format("{}", fmt::join(record.gate.red, " ")));
      answers[key] = answer(file, record.gate.red, folder.models);
    }
    GateProof proof{judged(folder, file, record.gate, answers[key], hash_of(file)), ""};
    if (!record.passes()) {
      proof.failure = "red without the change";
    } else if (!proof.changed.failure.empty()) {
      proof.failure = "no number: " + proof.changed.failure;
    } else if (proof.changed.within()) {
      proof.failure = "stays within its limit";
    }
    proofs.push_back(std::move(proof));
  }
  return proofs;
}

std::vector<std::string> regenerate(const GateFolder& folder, const GateNames& names, const ReferenceOptions& options,
                                    bool quiet) {
  std::vector<std::string> lines;
  std::set<path> written;
  for (const GateFile& file : folder.files) {
    if (file.reference.empty() || !is_asked(file, names) || !written.insert(file.reference).second) continue;
    const scene::Scene scene = scene_of(file);
    const scene::Surface surface = rest_surface(scene);
    std::string before = "new";
    try {
      before = fmt::format("{:.6g} N before", peak_n(stored_reference(file.reference, scene, surface).instants));
    } catch (const UnusableReference& error) {
      before = error.what();
    }
    const reference::Result result = solve_with_progress(scene, surface, options, quiet);
    store_reference(file.reference, scene, surface, result, "touchstone gate --regenerate " + file.name);
    lines.push_back(
        fmt::format("{}: peak force {:.6g} N ({})", file.reference.string(), peak_n(result.instants), before));
  }
  return lines;
}

std::vector<std::string> accept(const GateFolder& folder, const std::vector<GateRecord>& records) {
  std::map<std::string, AcceptedValue> accepted = folder.accepted;
  std::vector<std::string> lines;
  std::vector<scene::Fault> faults;
  for (const GateRecord& record : records) {
    if (record.gate.kind != GateKind::drift) continue;
    if (!record.value || !std::isfinite(*record.value)) {
      scene::Fault fault = record.gate.place;
      fault.message = record.name() + " cannot be accepted: " + record.failure;
      faults.push_back(std::move(fault));
      continue;
    }
    const AcceptedValue* before = accepted_of(folder, record.name());
    lines.push_back(fmt::format("{}: {} {} ({})", record.name(), *record.value, record.gate.unit,
                                before != nullptr ? fmt::format("{} before", before->value) : "new"));
    accepted[record.name()] = {*record.value, record.gate.unit, hash_of(file_of(folder, record.file))};
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  std::erase_if(accepted, [&](const auto& entry) { return !is_drift(folder, entry.first); });
  write_accepted(accepted_file(folder.folder), accepted);
  return lines;
}

}  // namespace touchstone::compare
