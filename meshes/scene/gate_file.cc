#include "scene/gate_file.h"

#include "scene/files.h"
#include "scene/nearest_name.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace touchstone::scene {
namespace {

toml::table parsed(std::string_view text, const std::filesystem::path& file) {
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    throw InputError({{file.string(), static_cast<int>(where.line), static_cast<int>(where.column),
                       "not valid TOML: " + std::string(error.description())}});
  }
}

class Reader {
 public:
  Reader(const toml::table& document, const std::filesystem::path& file) : document_(document), file_(file) {}

  GateFile gates() {
    GateFile out;
    out.name = file_.stem().string();
    known_keys(document_, "", {"title", "run", "scene", "set", "reference", "gate"});
    out.title = text(document_, "title");
    out.run = word(document_, "run", {"fast", "reference"}) == "reference" ? GateRun::reference : GateRun::fast;
    out.scene_file = (file_.parent_path() / text(document_, "scene")).lexically_normal();
    if (document_.contains("set")) out.set = settings(document_, "set");
    if (document_.contains("reference")) {
      out.reference = (file_.parent_path() / text(document_, "reference")).lexically_normal();
    }
    std::set<std::string> names;
    for (const toml::table* table : rows("gate")) {
      out.gates.push_back(gate(*table));
      if (!names.insert(out.gates.back().name).second) {
        add(*table, "gate.name: \"" + out.gates.back().name + "\" twice; expected different names");
      }
    }
    if (out.gates.empty()) add(document_, "no gate; expected [[gate]] rows");
    finish();
    return out;
  }

  std::vector<GateWaiver> waivers() {
    std::vector<GateWaiver> out;
    known_keys(document_, "", {"waiver"});
    for (const toml::table* table : rows("waiver")) {
      known_keys(*table, "waiver.", {"gate", "name", "reason", "until", "removed"});
      GateWaiver& waiver = out.emplace_back();
      waiver.place = place(table->source());
      waiver.gate = text(*table, "gate", "waiver.");
      waiver.name = text(*table, "name", "waiver.");
      waiver.reason = text(*table, "reason", "waiver.");
      const toml::node* until = table->get("until");
      if (until != nullptr && until->is_date()) {
        const toml::date day = until->as_date()->get();
        waiver.until = std::chrono::year(day.year) / day.month / day.day;
      } else {
        add(until != nullptr ? *until : *table, "waiver.until: expected a date, such as 2026-12-31");
      }
      if (const toml::node* removed = table->get("removed")) {
        if (!removed->is_boolean()) add(*removed, "waiver.removed: expected true or false");
        waiver.removed = removed->value_or(false);
      }
    }
    finish();
    return out;
  }

 private:
  [[nodiscard]] Fault place(const toml::source_region& source) const {
    return {file_.string(), static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), ""};
  }
  void add(const toml::source_region& source, const std::string& message) {
    Fault fault = place(source);
    fault.message = message;
    faults_.push_back(std::move(fault));
  }
  void add(const toml::node& node, const std::string& message) { add(node.source(), message); }
  void finish() {
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

  void known_keys(const toml::table& table, const std::string& row, const std::vector<std::string>& known) {
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      if (std::ranges::find(known, name) != known.end()) continue;
      add(key.source(),
          "unknown key \"" + row + name + "\"; did you mean \"" + row + nearest_name(name, known) + "\"?");
    }
  }

  /// @param may_be_empty  a unit may
  std::string text(const toml::table& table, const std::string& key, const std::string& row = "",
                   bool may_be_empty = false) {
    const toml::node* node = table.get(key);
    const std::string value = node != nullptr ? node->value_or(std::string()) : std::string();
    if (node != nullptr && node->is_string() && (may_be_empty || !value.empty())) return value;
    add(node != nullptr ? *node : table, row + key + ": expected a text");
    return "";
  }

  std::string word(const toml::table& table, const std::string& key, const std::vector<std::string>& words,
                   const std::string& row = "") {
    const toml::node* node = table.get(key);
    const std::string value = node != nullptr ? node->value_or(std::string()) : std::string();
    if (std::ranges::find(words, value) != words.end()) return value;
    std::string expected;
    for (const std::string& each : words) expected += (expected.empty() ? "\"" : " or \"") + each + "\"";
    add(node != nullptr ? *node : table, row + key + ": expected " + expected);
    return "";
  }

  std::vector<std::string> settings(const toml::table& table, const std::string& key, const std::string& row = "") {
    std::vector<std::string> list;
    const toml::node* node = table.get(key);
    const toml::array* array = node != nullptr ? node->as_array() : nullptr;
    if (array == nullptr || array->empty() || !array->is_homogeneous<std::string>()) {
      add(node != nullptr ? *node : table, row + key + ": expected a list of texts \"KEY=VALUE\" as for --set");
      return list;
    }
    for (const toml::node& element : *array) list.push_back(element.value_or(std::string()));
    return list;
  }

  std::vector<const toml::table*> rows(const std::string& key) {
    std::vector<const toml::table*> list;
    const toml::node* node = document_.get(key);
    if (node == nullptr) return list;
    const toml::array* array = node->as_array();
    if (array == nullptr || !array->is_array_of_tables()) {
      add(*node, key + ": expected [[" + key + "]] rows");
      return list;
    }
    for (const toml::node& row : *array) list.push_back(row.as_table());
    return list;
  }

  Gate gate(const toml::table& table) {
    const std::string row = "gate.";
    known_keys(table, row, {"name", "kind", "quantity", "limit", "unit", "reason", "red"});
    Gate gate;
    gate.name = text(table, "name", row);
    gate.kind = word(table, "kind", {"truth", "drift"}, row) == "drift" ? GateKind::drift : GateKind::truth;
    gate.quantity = text(table, "quantity", row);
    const toml::node* limit = table.get("limit");
    gate.limit = limit != nullptr && limit->is_number() ? *limit->value<double>() : NAN;
    const toml::node& at = limit != nullptr ? *limit : table;
    if (!(gate.limit > 0.0) || std::isinf(gate.limit)) add(at, "gate.limit: expected a number above 0");
    gate.place = place(at.source());
    gate.unit = text(table, "unit", row, true);
    gate.reason = text(table, "reason", row);
    gate.red = settings(table, "red", row);
    return gate;
  }

  const toml::table& document_;
  const std::filesystem::path& file_;
  std::vector<Fault> faults_;
};

}  // namespace

const char* name_of(GateKind kind) { return kind == GateKind::truth ? "truth" : "drift"; }

const char* name_of(GateRun run) { return run == GateRun::fast ? "fast" : "reference"; }

GateFile parse_gate_file(std::string_view text, const std::filesystem::path& file) {
  const toml::table document = parsed(text, file);
  return Reader(document, file).gates();
}

GateFile load_gate_file(const std::filesystem::path& file) {
  const std::optional<std::string> text = read_file(file);
  if (!text) throw InputError({{file.string(), 0, 0, "cannot read the gates; expected a readable TOML file"}});
  return parse_gate_file(*text, file);
}

std::vector<GateWaiver> load_gate_waivers(const std::filesystem::path& file) {
  const std::optional<std::string> text = read_file(file);
  if (!text) return {};
  const toml::table document = parsed(*text, file);
  return Reader(document, file).waivers();
}

}  // namespace touchstone::scene
