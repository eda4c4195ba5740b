// Files that are complete or absent, and folders that one process works in at a time, even if processes are killed.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace touchstone::scene {

/// Writes a file that is complete or absent even after a kill, a full disk or a power cut: to a temporary name of its
/// own, to the disk, then under its name. Several processes may write the same file at a time; one of them wins.
/// @throws std::filesystem::filesystem_error; the file is then what it was before
void write_file(const std::filesystem::path& path, std::string_view content);

/// A file written bit by bit that is whole or absent all the same: it grows under a temporary name of its own, never
/// through a link that another process left there, and is removed unless it is finished.
class UnfinishedFile {
 public:
  /// @throws std::filesystem::filesystem_error
  explicit UnfinishedFile(std::filesystem::path path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  /// @returns false once something could not be written; finish() gives the reason
  bool append(std::string_view content) noexcept;

  /// Brings all to the disk and gives the file its name.
  /// @returns false when the temporary file was removed by another process
  /// @throws std::filesystem::filesystem_error with the reason of the first failure
  [[nodiscard]] bool finish();

 private:
  std::filesystem::path path_, temporary_;
  int descriptor_ = -1, error_ = 0;
  bool finished_ = false;
};

/// The bytes of a file of our own, or nothing when there is none that can be read.
[[nodiscard]] std::optional<std::string> read_file(const std::filesystem::path& path);

/// Removes the temporary files that killed runs left in a folder, not in those below it, and nothing else: regular
/// files whose whole name is one that write_file() makes. A live run holds a lock on its own; on a file system that
/// without locks it may lose it here and writes it again.
/// @throws std::filesystem::filesystem_error
void remove_unfinished(const std::filesystem::path& folder);

/// Makes the folder and writes to it as a trial.
/// @param option  that named the folder, such as "--out"
/// @throws InputError with the reason, in one line
void require_writable(const std::filesystem::path& folder, const std::string& option);

/// A folder's lock, held from a successful try_take() to the end of the object or of the process: the kernel gives it
/// back, so a killed run leaves none. It is flock(2) on a file in the folder: between hosts it holds where the
/// file system carries it (NFS does since Linux 2.6.12, unless mounted with local_lock or nolock; Lustre with -o
/// flock). On a file system without locks every process gets it: work is then done twice, and write_file() keeps
/// every file whole.
class FolderLock {
 public:
  /// @throws std::filesystem::filesystem_error when the file cannot be opened for writing
  explicit FolderLock(const std::filesystem::path& folder, const std::string& name = "lock");
  FolderLock(FolderLock&& other) noexcept;
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// @returns at once, whether the lock is now held; @throws std::filesystem::filesystem_error
  [[nodiscard]] bool try_take();

  /// Takes the lock. @param waiting  called about five times a second while another process holds it; may throw
  void take(const std::function<void()>& waiting);

  /// Does some process work in the folder now? False too where that cannot be found out.
  [[nodiscard]] static bool held(const std::filesystem::path& folder);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace touchstone::scene
