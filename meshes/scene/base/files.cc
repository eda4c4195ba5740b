#include "scene/base/files.h"

#include "scene/base/descriptor.h"
#include "scene/base/error.h"
#include "scene/base/input.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

namespace touchstone::scene {
namespace {

/// Part of the name of a temporary file, between the file's name and "PROCESS-NUMBER"; unlikely in other names.
constexpr std::string_view unfinished_mark = ".touchstone-part-";

/// Whether a name has the form of open_temporary().
bool is_temporary(std::string_view name) {
  const std::size_t mark = name.rfind(unfinished_mark);
  if (mark == std::string_view::npos || mark == 0) return false;
  const std::string_view numbers = name.substr(mark + unfinished_mark.size());
  const std::size_t dash = numbers.find('-');
  if (dash == std::string_view::npos) return false;
  const auto whole = [](std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  return whole(numbers.substr(0, dash)) && whole(numbers.substr(dash + 1));
}

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path, int error) {
  throw std::filesystem::filesystem_error(what, path, std::error_code(error, std::generic_category()));
}

/// Opens a new file that no other process writes to; `temporary` becomes its name. The descriptor is -1 on failure,
/// with errno set.
int open_temporary(const std::filesystem::path& path, std::filesystem::path& temporary) {
  for (int number = 0;; ++number) {
    temporary = path;
    temporary += std::string(unfinished_mark) + std::to_string(::getpid()) + "-" + std::to_string(number);
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
}

/// @returns 0 or the error number
int write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// Writes a file, or a folder's list of names, to the disk. @returns 0 or the error number
int sync(int file) {
  // EINVAL: the file system has no disk.
  return ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
}

}  // namespace

UnfinishedFile::UnfinishedFile(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = open_temporary(path_, temporary_);
  if (descriptor_ < 0) fail("cannot write", path_, errno);
  // Shows remove_unfinished() that this run is active, until the file has its final name.
  ::flock(descriptor_, LOCK_EX);
}

UnfinishedFile::~UnfinishedFile() {
  if (!finished_) ::unlink(temporary_.c_str());
  ::close(descriptor_);
}

bool UnfinishedFile::append(std::string_view content) noexcept {
  if (error_ == 0) error_ = write_all(descriptor_, content);
  return error_ == 0;
}

bool UnfinishedFile::finish() {
  if (error_ == 0) error_ = sync(descriptor_);
  // A network file system may report a full disk only when a file is closed; closing a duplicate keeps the lock.
  const int copy = ::dup(descriptor_);
  if ((copy < 0 || ::close(copy) != 0) && error_ == 0) error_ = errno;
  if (error_ == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) error_ = errno;
  if (error_ == ENOENT) return false;
  if (error_ != 0) fail("cannot write", path_, error_);
  finished_ = true;
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  const Descriptor names(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (names.number() < 0) fail("cannot open", folder, errno);
  if (const int error = sync(names.number()); error != 0) fail("cannot write", folder, error);
  return true;
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  constexpr int attempts = 20;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    UnfinishedFile file(path);
    file.append(content);
    if (file.finish()) return;
  }
  fail("cannot write", path, ENOENT);
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
  constexpr InputKind own{"a file of Touchstone's own", std::uintmax_t{16} << 30};
  Input input = read_input(path, own);
  return input.fault.empty() ? std::optional(std::move(input.bytes)) : std::nullopt;
}

void remove_unfinished(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!is_temporary(entry.path().filename().string()) || !std::filesystem::is_regular_file(entry.symlink_status())) {
      continue;
    }
    const Descriptor file(::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    const bool of_a_live_run =
        file.number() >= 0 && ::flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!of_a_live_run) std::filesystem::remove(entry.path());
  }
}

void require_writable(const std::filesystem::path& folder, const std::string& option) {
  const auto refuse = [&](const std::string& what, const std::error_code& error) {
    throw InputError(option + " " + folder.string() + ": " + what + " (" + error.message() +
                     "); expected a folder that can be written to");
  };
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) refuse("cannot create the folder", error);
  // For root and on a read-only disk permissions do not tell, so try to write.
  std::filesystem::path probe;
  const Descriptor file(open_temporary(folder / "probe", probe));
  int number = file.number() < 0 ? errno : write_all(file.number(), "probe");
  ::unlink(probe.c_str());
  if (number != 0) refuse("cannot write there", std::error_code(number, std::generic_category()));
}

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& name) : file_(folder / name) {
  // Non-blocking: it may be a pipe.
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("cannot open", file_, errno);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);  // releases the lock
}

bool FolderLock::try_take() {
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return true;
  if (errno == EWOULDBLOCK || errno == EINTR) return false;
  if (errno == ENOSYS || errno == EOPNOTSUPP || errno == ENOLCK) return true;
  fail("cannot lock", file_, errno);
}

void FolderLock::take(const std::function<void()>& waiting) {
  while (!try_take()) {
    waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

bool FolderLock::held(const std::filesystem::path& folder) {
  const Descriptor file(::open((folder / "lock").c_str(), O_RDWR | O_CLOEXEC));
  return file.number() >= 0 && ::flock(file.number(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

}  // namespace touchstone::scene
