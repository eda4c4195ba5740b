// What the readers of study files share: typed access to a TOML document that collects every fault with its place.
#pragma once

#include "scene/base/error.h"

#include <toml++/toml.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// One value of one key of the scene.
struct Setting {
  std::string key, value;  ///< value as TOML
  Fault place;             ///< its position in the file; its message is empty
};

/// The kind of a TOML file of ours, determined by its tables.
enum class FileKind { scene, sweep, tuning, gates };

/// @throws InputError when the document is clearly of another kind than wanted, with the command that takes it
void require_kind(const toml::table& document, const std::filesystem::path& file, FileKind wanted);

/// The text's document; every TOML file is parsed here. @param file  for messages. @throws InputError when it is no
/// TOML
[[nodiscard]] toml::table parse_document(std::string_view text, const std::string& file);

/// The file's document. @param what  for messages: "the study". @throws InputError when it cannot be read or is no TOML
[[nodiscard]] toml::table read_document(const std::filesystem::path& file, const std::string& what);

/// A value as TOML that reads back the same.
[[nodiscard]] std::string value_text(const toml::node& node);

/// Base of a reader of one document, which must outlive it.
class TomlReader {
 public:
  TomlReader(const toml::table& document, const std::filesystem::path& file) : document_(document), file_(file) {}

 protected:
  /// @throws InputError with what was collected, if anything
  void refuse_faults();

  [[nodiscard]] Fault place(const toml::source_region& source) const;
  void add(const toml::source_region& source, const std::string& message);
  void add(const toml::node& node, const std::string& message) { add(node.source(), message); }

  /// @param row  before every key in a message: "axis."
  void known_keys(const toml::table& table, const std::string& row, const std::vector<std::string>& known);
  std::optional<std::string> text(const toml::table& table, const std::string& key);
  /// One of several words. @param otherwise  for a key that is absent; without it the key must be given
  std::string word(const toml::table& table, const std::string& key, const std::vector<std::string>& words,
                   const std::optional<std::string>& otherwise = std::nullopt);
  /// The tables of [[key]].
  std::vector<const toml::table*> rows(const std::string& key);
  /// A table of settings, its tables within tables spelt as dotted keys.
  std::vector<Setting> settings(const toml::table& table, const std::string& key);

  const toml::table& document_;
  const std::filesystem::path& file_;
  std::vector<Fault> faults_;

 private:
  void flatten(const toml::table& table, const std::string& above, std::vector<Setting>& list) const;
};

}  // namespace touchstone::scene
