#include "reference/run/store.h"

#include "scene/base/hash.h"

#include <iostream>
#include <stdexcept>

namespace touchstone::reference {
namespace {

/// Raised when the files change, so that older ones are not found; what is in a record, method_version answers for.
constexpr std::string_view format_version = "touchstone store 2\n";

// A step's file: "what it is, checksum, line feed, the record".
constexpr std::string_view magic = "touchstone reference step 2\n";
constexpr std::size_t checksum_size = 32;

}  // namespace

Store::Store(const std::filesystem::path& root, const std::string& identity, const std::function<void()>& waiting)
    : folder_(root / key(identity)) {
  scene::require_writable(folder_, "--store");
  lock_.emplace(folder_);
  lock_->take(waiting);
  scene::remove_unfinished(folder_);
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.is_directory()) scene::remove_unfinished(entry);
  }
  // For the reader of the folder; the name is the hash of this text.
  const std::filesystem::path about = folder_ / "identity.txt";
  if (std::filesystem::exists(about) && scene::read_file(about) != identity) {
    std::cerr
        << "warning: " << about.string()
        << ": is not the text that the folder is named by; written again. The answers beside it carry checksums of "
           "their own.\n";
  } else if (std::filesystem::exists(about)) {
    return;
  }
  scene::write_file(about, identity);
}

std::string Store::key(const std::string& identity) { return scene::hash_text(std::string(format_version) + identity); }

std::filesystem::path Store::step_file(int level, int instant) const {
  return folder_ / ("level-" + std::to_string(level + 1)) / ("instant-" + std::to_string(instant + 1) + ".step");
}

void Store::write(int level, int instant, std::string_view record) const { write(step_file(level, instant), record); }

void Store::write(const std::string& name, std::string_view record) const { write(folder_ / (name + ".step"), record); }

std::optional<std::string> Store::read(int level, int instant) const { return read(step_file(level, instant)); }

std::optional<std::string> Store::read(const std::string& name) const { return read(folder_ / (name + ".step")); }

std::string Store::checksum(const std::filesystem::path& file, std::string_view bytes) const {
  std::string text = folder_.filename().string() + ' ' + file.lexically_relative(folder_).generic_string() + '\n';
  return scene::hash_text(text += bytes);
}

void Store::write(const std::filesystem::path& file, std::string_view record) const {
  std::string content(magic);
  content += checksum(file, record);
  content += '\n';
  content += record;
  try {
    std::filesystem::create_directories(file.parent_path());
    scene::write_file(file, content);
  } catch (const std::filesystem::filesystem_error& error) {
    throw std::filesystem::filesystem_error(
        "cannot keep this load step; those before it are kept, and the next run goes on from there", file,
        error.code());
  }
}

std::optional<std::string> Store::read(const std::filesystem::path& file) const {
  const std::optional<std::string> content = scene::read_file(file);
  if (!content) return std::nullopt;
  const std::size_t head = magic.size() + checksum_size + 1;
  if (content->size() >= head && content->starts_with(magic)) {
    std::string bytes = content->substr(head);
    if (content->compare(magic.size(), checksum_size, checksum(file, bytes)) == 0) return bytes;
  }
  std::filesystem::remove(file);
  return std::nullopt;
}

}  // namespace touchstone::reference
