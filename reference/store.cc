#include "reference/store.h"

#include "scene/hash.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace touchstone::reference {
namespace {

// "what it is, hash of the rest, line feed, the rest"
constexpr std::string_view magic = "touchstone reference step\n";
constexpr std::size_t hash_size = 32;

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path) {
  throw std::filesystem::filesystem_error(what, path, std::error_code(errno, std::generic_category()));
}

/// Makes a file or a folder's list of names survive a power cut.
void sync(const std::filesystem::path& path, int flags) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0) fail("cannot open", path);
  const int result = ::fsync(file);
  ::close(file);
  if (result != 0) fail("cannot write to disk", path);
}

void write_whole(const std::filesystem::path& path, std::string_view content) {
  std::filesystem::path temporary = path;
  temporary += ".part";
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (!file) fail("cannot write", temporary);
  }
  sync(temporary, O_RDWR);
  std::filesystem::rename(temporary, path);
  sync(path.parent_path(), O_RDONLY | O_DIRECTORY);
}

}  // namespace

void Record::put(std::string_view text) {
  put(static_cast<int>(text.size()));
  append(text.data(), text.size());
}

void Record::append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

void Record::extract(void* data, std::size_t size) {
  if (size > bytes_.size() - place_) throw std::out_of_range("the record ends too early");
  std::memcpy(data, bytes_.data() + place_, size);
  place_ += size;
}

double Record::take_double() {
  double value;
  extract(&value, sizeof value);
  return value;
}

int Record::take_int() {
  int value;
  extract(&value, sizeof value);
  return value;
}

std::string Record::take_text() {
  const int size = take_int();
  if (size < 0 || static_cast<std::size_t>(size) > bytes_.size() - place_) throw std::out_of_range("not a text");
  std::string text(static_cast<std::size_t>(size), '\0');
  extract(text.data(), text.size());
  return text;
}

Store::Store(const std::filesystem::path& root, const std::string& identity) : folder_(root / key(identity)) {
  std::filesystem::create_directories(folder_);
  const std::filesystem::path lock_file = folder_ / "lock";
  lock_ = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) fail("cannot open", lock_file);
  // For the reader of the folder; the name is the hash of this text.
  if (!std::filesystem::exists(folder_ / "identity.txt")) write_whole(folder_ / "identity.txt", identity);
}

Store::~Store() {
  if (lock_ >= 0) ::close(lock_);  // which gives the lock back
}

bool Store::try_lock() {
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return true;
  if (errno != EWOULDBLOCK && errno != EINTR) fail("cannot lock", folder_ / "lock");
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  return false;
}

std::string Store::key(const std::string& identity) { return scene::hash_text(identity); }

std::filesystem::path Store::step_file(int level, int instant) const {
  return folder_ / ("level-" + std::to_string(level + 1)) / ("instant-" + std::to_string(instant + 1) + ".step");
}

void Store::write(int level, int instant, const Record& record) const {
  write_checked(step_file(level, instant), record);
}

void Store::write(const std::string& name, const Record& record) const {
  write_checked(folder_ / (name + ".step"), record);
}

std::optional<Record> Store::read(int level, int instant) const { return read_checked(step_file(level, instant)); }

std::optional<Record> Store::read(const std::string& name) const { return read_checked(folder_ / (name + ".step")); }

void Store::write_checked(const std::filesystem::path& file, const Record& record) {
  std::filesystem::create_directories(file.parent_path());
  std::string content(magic);
  content += scene::hash_text(record.bytes());
  content += '\n';
  content += record.bytes();
  write_whole(file, content);
}

std::optional<Record> Store::read_checked(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::size_t head = magic.size() + hash_size + 1;
  if (content.size() >= head && content.starts_with(magic)) {
    std::string bytes = content.substr(head);
    if (content.compare(magic.size(), hash_size, scene::hash_text(bytes)) == 0) return Record(std::move(bytes));
  }
  std::filesystem::remove(path);
  return std::nullopt;
}

}  // namespace touchstone::reference
