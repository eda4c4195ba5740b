#include "compare/input/gate_file.h"

#include "scene/base/input.h"
#include "scene/base/text.h"
#include "scene/input/toml_reader.h"

#include <cmath>
#include <optional>
#include <set>

namespace touchstone::compare {

using namespace scene;  // the TOML reader and its types
namespace {

std::vector<std::string> names_of(const std::vector<GateKey>& keys, const char* rows = nullptr) {
  std::vector<std::string> names;
  for (const GateKey& key : keys) names.push_back(key.key);
  if (rows != nullptr) names.emplace_back(rows);
  return names;
}

std::string key_table(const std::vector<GateKey>& keys, const std::string& row) {
  std::string text = "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const GateKey& key : keys) {
    text += "| `" + row + key.key + "` | " + key.value + " | " +
            (key.default_value.empty() ? "required" : key.default_value) + " | " + key.meaning + " |\n";
  }
  return text;
}

class Reader : TomlReader {
 public:
  using TomlReader::TomlReader;

  GateFile gates() {
    GateFile out;
    out.name = file_.stem().string();
    known_keys(document_, "", names_of(gate_file_keys(), "gate"));
    out.title = given_text(document_, "title");
    const std::string run = word(document_, "run", {"fast", "reference", "second_code"});
    for (const GateRun one : {GateRun::fast, GateRun::reference, GateRun::second_code}) {
      if (run == name_of(one)) out.run = one;
    }
    if (document_.contains("model")) {
      out.model = given_text(document_, "model");
      if (out.run != GateRun::fast) add(document_, "model is for run = \"fast\" only; expected none");
    }
    out.scene_file = (file_.parent_path() / given_text(document_, "scene")).lexically_normal();
    if (document_.contains("set")) out.set = given_settings(document_, "set");
    if (document_.contains("reference")) {
      out.reference = (file_.parent_path() / given_text(document_, "reference")).lexically_normal();
      if (out.run == GateRun::second_code) {
        add(document_, "reference is not used with run = \"second_code\"; expected none");
      }
    }
    std::set<std::string> names;
    for (const toml::table* table : rows("gate")) {
      out.gates.push_back(gate(*table));
      if (!names.insert(out.gates.back().name).second) {
        add(*table, "gate.name: \"" + out.gates.back().name + "\" twice; expected different names");
      }
    }
    if (out.gates.empty()) add(document_, "no gate; expected [[gate]] rows");
    refuse_faults();
    return out;
  }

  std::vector<GateWaiver> waivers() {
    std::vector<GateWaiver> out;
    known_keys(document_, "", {"waiver"});
    for (const toml::table* table : rows("waiver")) {
      known_keys(*table, "waiver.", names_of(waiver_keys()));
      GateWaiver& waiver = out.emplace_back();
      waiver.place = place(table->source());
      waiver.gate = given_text(*table, "gate", "waiver.");
      waiver.name = given_text(*table, "name", "waiver.");
      waiver.reason = given_text(*table, "reason", "waiver.");
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
    refuse_faults();
    return out;
  }

 private:
  /// A text that is required. @param may_be_empty  as for a unit
  std::string given_text(const toml::table& table, const std::string& key, const std::string& row = "",
                         bool may_be_empty = false) {
    const toml::node* node = table.get(key);
    std::string value = node != nullptr ? node->value_or(std::string()) : std::string();
    if (node != nullptr && node->is_string() && (may_be_empty || !value.empty()) && is_plain_text(value)) return value;
    add(node != nullptr ? *node : table, row + key + ": expected a text without control characters");
    return "";
  }

  /// A list of texts KEY=VALUE, as for --set.
  std::vector<std::string> given_settings(const toml::table& table, const std::string& key,
                                          const std::string& row = "") {
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

  Gate gate(const toml::table& table) {
    const std::string row = "gate.";
    known_keys(table, row, names_of(gate_keys()));
    Gate gate;
    gate.name = given_text(table, "name", row);
    gate.kind = word(table, "kind", {"truth", "drift"}) == "drift" ? GateKind::drift : GateKind::truth;
    gate.quantity = given_text(table, "quantity", row);
    const toml::node* limit = table.get("limit");
    gate.limit = limit != nullptr && limit->is_number() ? *limit->value<double>() : NAN;
    const toml::node& at = limit != nullptr ? *limit : table;
    if (!(gate.limit > 0.0) || std::isinf(gate.limit)) add(at, "gate.limit: expected a number above 0");
    gate.place = place(at.source());
    gate.unit = given_text(table, "unit", row, true);
    gate.reason = given_text(table, "reason", row);
    gate.red = given_settings(table, "red", row);
    return gate;
  }
};

}  // namespace

const std::vector<GateKey>& gate_file_keys() {
  static const std::vector<GateKey> keys = {
      {"title", "a text", "", "What the gates hold, for lists and reports."},
      {"run", "\"fast\" or \"reference\" or \"second_code\"", "",
       "What is computed anew. \"fast\": the fast model, compared with the reference data named by `reference`; "
       "\"reference\": a new solve of the reference, without the store; \"second_code\": CalculiX and the reference on "
       "the same "
       "deck."},
      {"model", "a text", "the fast model",
       "With `run = \"fast\"`: another model in its place, by its key in `summary.json` of `touchstone trade`, such as "
       "\"compliance-1\". It has no `fast.` figures."},
      {"scene", "a path", "", "The scene file, relative to the gate file."},
      {"set", "a list of texts \"KEY=VALUE\"", "none",
       "Values over the scene's, as for `--set`. They belong to the scene: the reference data is of them, too."},
      {"reference", "a path", "none",
       "Folder of the committed reference data, relative to the gate file; written by `touchstone gate --regenerate "
       "FILE`. Never with `run = \"second_code\"`."},
  };
  return keys;
}

const std::vector<GateKey>& gate_keys() {
  static const std::vector<GateKey> keys = {
      {"name", "a text", "",
       "Of the gate, different from the others in its file; on the command line it is FILE.NAME, FILE without "
       "`.toml`."},
      {"kind", "\"truth\" or \"drift\"", "",
       "\"truth\": the absolute value plus the reference's uncertainty must stay within the limit; \"drift\": the "
       "distance from the value last accepted with `touchstone gate --accept FILE.NAME`."},
      {"quantity", "a text", "", "A key of `summary.json` of that run, such as \"force.nrmse\"."},
      {"limit", "a number above 0, in `unit`", "", "The largest value allowed."},
      {"unit", "a text", "", "Of the quantity, as in `summary.json`; \"\" for a ratio. Another unit is red."},
      {"reason", "a text", "", "Why the limit is what it is; printed when the gate is red."},
      {"red", "a list of texts \"KEY=VALUE\", at least one", "",
       "A change, as for `--set`, that must turn the gate red; `touchstone gate --prove` applies it."},
  };
  return keys;
}

const std::vector<GateKey>& waiver_keys() {
  static const std::vector<GateKey> keys = {
      {"gate", "a text", "", "The gate, as FILE.NAME."},
      {"name", "a text", "", "Who is responsible for it."},
      {"reason", "a text", "", "Why the limit may be wider."},
      {"until", "a date, 2026-12-31", "", "The last day on which it holds; from the next day on the gate is red."},
      {"removed", "true or false", "`false`", "The waiver is for a gate that was taken away."},
  };
  return keys;
}

std::string gate_reference_markdown() {
  return "# Gate reference\n\n"
         "Every key of a gate file, `GATES/<file>.toml`, and of the file of waivers, `GATES/waivers.toml`; GATES is "
         "`tests/gates` or\nthe folder given with `touchstone gate --gates`. What gates are: [gates.md](gates.md). A "
         "key that is neither given nor has\na default is an error, as is one that is unknown.\n\n"
         "## A gate file\n\nAt its top:\n\n" +
         key_table(gate_file_keys(), "") + "\nEach gate is a `[[gate]]` row, at least one:\n\n" +
         key_table(gate_keys(), "gate[].") +
         "\n## Waivers\n\nThey count with `touchstone gate --base COMMIT` only. Each is a `[[waiver]]` row:\n\n" +
         key_table(waiver_keys(), "waiver[].");
}

const char* name_of(GateKind kind) { return kind == GateKind::truth ? "truth" : "drift"; }

const char* name_of(GateRun run) {
  switch (run) {
    case GateRun::fast:
      return "fast";
    case GateRun::reference:
      return "reference";
    case GateRun::second_code:
      return "second_code";
  }
  return "";
}

GateFile parse_gate_file(std::string_view text, const std::filesystem::path& file) {
  const toml::table document = parse_document(text, file.string());
  require_kind(document, file, FileKind::gates);
  return Reader(document, file).gates();
}

GateFile load_gate_file(const std::filesystem::path& file) {
  return parse_gate_file(require_input(file, toml_input, "the gates"), file);
}

std::vector<GateWaiver> load_gate_waivers(const std::filesystem::path& file) {
  if (std::error_code error; !std::filesystem::exists(file, error) && !error) return {};
  const toml::table document = read_document(file, "the waivers");
  return Reader(document, file).waivers();
}

}  // namespace touchstone::compare
