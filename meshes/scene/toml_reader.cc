#include "scene/toml_reader.h"

#include "scene/fields.h"
#include "scene/files.h"
#include "scene/nearest_name.h"

#include <algorithm>

namespace touchstone::scene {

namespace {

std::optional<FileKind> kind_of(const toml::table& document) {
  const auto has = [&](const char* key) { return document.contains(key); };
  if (has("gate")) return FileKind::gates;
  if (has("training") || has("held_out") || document["kind"].value<std::string>() == "tuning") return FileKind::tuning;
  if (has("axis") || has("case") || document["kind"].value<std::string>() == "sweep") return FileKind::sweep;
  if (has("body") || has("tool") || has("track")) return FileKind::scene;
  return std::nullopt;
}

std::string name_of(FileKind kind) {
  switch (kind) {
    case FileKind::scene:
      return "a scene";
    case FileKind::sweep:
      return "a study of many cases";
    case FileKind::tuning:
      return "a tuning study";
    case FileKind::gates:
      return "a gate file";
  }
  return "";
}

std::string command_for(FileKind kind, const std::filesystem::path& file) {
  switch (kind) {
    case FileKind::scene:
      return "touchstone compare " + file.string() + " (or plan, fast, live, reference, trade, export)";
    case FileKind::sweep:
      return "touchstone study expand " + file.string();
    case FileKind::tuning:
      return "touchstone tune " + file.string();
    case FileKind::gates:
      return "touchstone gate --gates " + (file.has_parent_path() ? file.parent_path().string() : ".");
  }
  return "";
}

}  // namespace

void require_kind(const toml::table& document, const std::filesystem::path& file, FileKind wanted) {
  const std::optional<FileKind> kind = kind_of(document);
  if (!kind || *kind == wanted) return;
  throw InputError({{file.string(), 0, 0,
                     "this is " + name_of(*kind) + ", expected " + name_of(wanted) +
                         "; the verb for it is: " + command_for(*kind, file)}});
}

toml::table parse_document(std::string_view text, const std::filesystem::path& file) {
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    throw InputError({{file.string(), static_cast<int>(where.line), static_cast<int>(where.column),
                       "not valid TOML: " + std::string(error.description())}});
  }
}

toml::table read_document(const std::filesystem::path& file) {
  const std::optional<std::string> text = read_file(file);
  if (!text) {
    throw InputError(
        {{file.string(), 0, 0, "cannot read the study; expected a readable TOML file" + did_you_mean_file(file)}});
  }
  return parse_document(*text, file);
}

std::string value_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  std::string text;
  if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) text += (text.empty() ? "" : ", ") + value_text(element);
    return "[" + text + "]";
  }
  if (const auto* table = node.as_table()) {
    for (const auto& [key, element] : *table) {
      text += (text.empty() ? "" : ", ") + std::string(key.str()) + " = " + value_text(element);
    }
    return "{" + text + "}";
  }
  for (const char c : node.value_or(std::string_view())) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return "\"" + text + "\"";
}

void TomlReader::refuse_faults() {
  if (!faults_.empty()) throw InputError(std::move(faults_));
}

Fault TomlReader::place(const toml::source_region& source) const {
  return {file_.string(), static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), ""};
}

void TomlReader::add(const toml::source_region& source, const std::string& message) {
  Fault fault = place(source);
  fault.message = message;
  faults_.push_back(std::move(fault));
}

void TomlReader::known_keys(const toml::table& table, const std::string& row, const std::vector<std::string>& known) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    add(key.source(), "unknown key \"" + row + name + "\"; did you mean \"" + row + nearest_name(name, known) + "\"?");
  }
}

std::optional<std::string> TomlReader::text(const toml::table& table, const std::string& key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_string()) return node->value<std::string>();
  add(*node, key + " = " + value_text(*node) + "; expected a text");
  return std::nullopt;
}

std::string TomlReader::word(const toml::table& table, const std::string& key, const std::vector<std::string>& words,
                             const std::optional<std::string>& otherwise) {
  const toml::node* node = table.get(key);
  if (node == nullptr && otherwise) return *otherwise;
  std::string expected;
  for (const std::string& each : words) expected += (expected.empty() ? "\"" : " or \"") + each + "\"";
  if (node == nullptr) {
    add(table, key + ": missing; expected " + expected);
  } else if (!node->is_string() ||
             std::find(words.begin(), words.end(), node->value_or(std::string())) == words.end()) {
    add(*node, key + " = " + value_text(*node) + "; expected " + expected +
                   did_you_mean(node->value_or(std::string()), words));
  } else {
    return node->value_or(std::string());
  }
  return "";
}

std::vector<const toml::table*> TomlReader::rows(const std::string& key) {
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

std::vector<StudySetting> TomlReader::settings(const toml::table& table, const std::string& key) {
  std::vector<StudySetting> list;
  const toml::node* node = table.get(key);
  if (node == nullptr) return list;
  if (node->is_table()) {
    flatten(*node->as_table(), "", list);
  } else {
    add(*node, key + ": expected a table of keys as for --set");
  }
  return list;
}

void TomlReader::flatten(const toml::table& table, const std::string& above, std::vector<StudySetting>& list) const {
  for (const auto& [key, node] : table) {
    const std::string name = above + std::string(key.str());
    if (node.is_table()) {
      flatten(*node.as_table(), name + ".", list);
    } else {
      list.push_back({name, value_text(node), place(node.source())});
    }
  }
}

}  // namespace touchstone::scene
