#include "scene/input/toml_reader.h"

#include "scene/base/input.h"
#include "scene/base/nearest_name.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"

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

/// Refuses, with its place, input that is no valid TOML and that the parser cannot handle: bytes that are not UTF-8, a
/// zero byte, a character beyond ASCII outside of quotes and comments, and a key of very many parts.
class Guard {
 public:
  Guard(std::string_view text, const std::string& file) : text_(without_mark(text)), file_(file) {}

  void check() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      const std::size_t length = utf8_length(rest);
      if (length == 0) refuse("a byte that is not UTF-8");
      if (rest[0] == '\0') refuse("a zero byte");
      if (quotes_.empty() && !comment_) {
        if (length > 1) refuse("a character that is not ASCII, outside of quotes and comments");
        count_parts(rest[0]);
      }
      step(begin_or_end(rest, length));
    }
  }

 private:
  /// Advances over quotes that begin or end a string, or over one character. @returns its length in bytes
  std::size_t begin_or_end(std::string_view rest, std::size_t length) {
    const char c = rest[0];
    if (c == '\n') {
      comment_ = false;
      if (quotes_.size() == 1) quotes_ = {};
    } else if (comment_) {
      return length;
    } else if (quotes_.empty()) {
      comment_ = c == '#';
      if (c == '"' || c == '\'') return (quotes_ = rest.substr(0, rest.starts_with(std::string(3, c)) ? 3 : 1)).size();
    } else if (c == '\\' && quotes_[0] == '"' && rest.size() > 1 && utf8_length(rest.substr(1)) == 1 &&
               rest[1] != '\n' && rest[1] != '\0') {
      return 2;
    } else if (rest.starts_with(quotes_)) {
      // A string may end in quotes that belong to it, before the three closing ones.
      std::size_t count = quotes_.size();
      while (quotes_.size() == 3 && count < 5 && rest.substr(count).starts_with(c)) ++count;
      quotes_ = {};
      return count;
    }
    return length;
  }

  void step(std::size_t bytes) {
    for (const char c : text_.substr(at_, bytes)) {
      if (c == '\n') ++line_, column_ = 1;
      if (c != '\n' && (static_cast<unsigned char>(c) & 0xc0) != 0x80) ++column_;
    }
    at_ += bytes;
  }

  void count_parts(char c) {
    constexpr int parts_max = 16;
    if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) parts_ = 1;
    if (c == '.' && ++parts_ > parts_max) refuse("a key of more than " + std::to_string(parts_max) + " parts");
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError({{file_, line_, column_, "not valid TOML: " + what}});
  }

  std::string_view text_;
  const std::string& file_;
  std::string_view quotes_;  ///< quotes of the string that contains at_
  bool comment_ = false;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1, parts_ = 1;
};

}  // namespace

void require_kind(const toml::table& document, const std::filesystem::path& file, FileKind wanted) {
  const std::optional<FileKind> kind = kind_of(document);
  if (!kind || *kind == wanted) return;
  throw InputError({{file.string(), 0, 0,
                     "this is " + name_of(*kind) + ", expected " + name_of(wanted) +
                         "; the command for it is: " + command_for(*kind, file)}});
}

toml::table parse_document(std::string_view text, const std::string& file) {
  Guard(text, file).check();
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    throw InputError({{file, static_cast<int>(where.line), static_cast<int>(where.column),
                       "not valid TOML: " + std::string(error.description())}});
  }
}

toml::table read_document(const std::filesystem::path& file, const std::string& what) {
  return parse_document(require_input(file, toml_input, what), file.string());
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
  return toml_quoted(node.value_or(std::string_view()));
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
    std::vector<std::string> names;
    if (faults_.size() < faults_shown_max) {
      for (const std::string& each : known) names.push_back(row + each);
    }
    add(key.source(), unknown_key(row + name, row + name, names, faults_.size()));
  }
}

std::optional<std::string> TomlReader::text(const toml::table& table, const std::string& key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_string() && is_plain_text(node->value_or(std::string_view()))) return node->value<std::string>();
  add(*node, key + " = " + shortened(value_text(*node)) + "; expected a text without control characters");
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
    add(*node, key + " = " + shortened(value_text(*node)) + "; expected " + expected +
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

std::vector<Setting> TomlReader::settings(const toml::table& table, const std::string& key) {
  std::vector<Setting> list;
  const toml::node* node = table.get(key);
  if (node == nullptr) return list;
  if (node->is_table()) {
    flatten(*node->as_table(), "", list);
  } else {
    add(*node, key + ": expected a table of keys as for --set");
  }
  return list;
}

void TomlReader::flatten(const toml::table& table, const std::string& above, std::vector<Setting>& list) const {
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
