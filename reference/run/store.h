// Results on disk, addressed by content: one folder per scene answer, one checked file per finished load step.
#pragma once

#include "scene/base/files.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::reference {

/// The folder of one answer. Holding an object of this class holds the folder's lock: a second process waits.
///
/// A process may be killed at any time, and the next one continues: a step is on disk completely or not at all,
/// incomplete files are removed, and a step's file is used only if its checksum, which covers the answer, level and
/// instant it belongs to, is right. On a file system without locks two processes do the same work twice.
class Store {
 public:
  /// @param identity  everything that changes the answer, as text; the folder is named by its hash
  /// @param waiting   called about five times a second while another process holds the lock; may throw to give up
  /// @throws scene::InputError when the folder cannot be written to, std::filesystem::filesystem_error
  Store(const std::filesystem::path& root, const std::string& identity, const std::function<void()>& waiting);

  /// Folder name for an identity: XXH3, 128 bits, hexadecimal, of it and the version of the files.
  [[nodiscard]] static std::string key(const std::string& identity);

  /// Keeps a finished step. @throws std::filesystem::filesystem_error; the step is then absent
  void write(int level, int instant, std::string_view record) const;

  /// The same for a named solution that is no step of a level.
  void write(const std::string& name, std::string_view record) const;
  [[nodiscard]] std::optional<std::string> read(const std::string& name) const;

  /// The step, or nothing when it is missing, torn, altered or another step's; such a file is removed.
  [[nodiscard]] std::optional<std::string> read(int level, int instant) const;

  [[nodiscard]] std::filesystem::path step_file(int level, int instant) const;

 private:
  void write(const std::filesystem::path& file, std::string_view record) const;
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& file) const;
  [[nodiscard]] std::string checksum(const std::filesystem::path& file, std::string_view bytes) const;
  std::filesystem::path folder_;
  std::optional<scene::FolderLock> lock_;
};

}  // namespace touchstone::reference
