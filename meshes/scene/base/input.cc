#include "scene/base/input.h"

#include "scene/base/descriptor.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace touchstone::scene {
namespace {

std::string error_text(int error) { return std::generic_category().message(error); }

std::string kind_text(mode_t mode) {
  return S_ISDIR(mode)                    ? "a folder"
         : S_ISFIFO(mode)                 ? "a pipe"
         : S_ISCHR(mode) || S_ISBLK(mode) ? "a device"
         : S_ISSOCK(mode)                 ? "a socket"
                                          : "not a regular file";
}

std::string size_text(std::uintmax_t bytes) {
  return bytes >> 30 > 0 ? std::to_string(bytes >> 30) + " GiB" : std::to_string(bytes >> 20) + " MiB";
}

}  // namespace

Input read_input(const std::filesystem::path& path, const InputKind& kind) {
  const auto refuse = [&](const std::string& why) {
    return Input{"", why + "; expected " + std::string(kind.expected) + " of at most " + size_text(kind.bytes_max)};
  };
  // The system would end the name there.
  if (path.native().find('\0') != std::string::npos) return refuse("its name holds a zero byte");
  // Non-blocking: a pipe would wait for its other end.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.number() < 0 && errno == ENOENT) {
    Input absent = refuse("there is no such file");
    absent.fault += did_you_mean_file(path);
    return absent;
  }
  struct stat about {};
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) return refuse(error_text(errno));
  if (!S_ISREG(about.st_mode)) return refuse("it is " + kind_text(about.st_mode));
  const auto size = static_cast<std::uintmax_t>(about.st_size);
  if (size > kind.bytes_max) return refuse("it has " + std::to_string(size) + " bytes");
  Input input;
  input.bytes.resize(size);
  std::size_t at = 0;
  while (at < size) {
    const ssize_t got = ::read(file.number(), input.bytes.data() + at, size - at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return refuse(error_text(errno));
    if (got == 0) return refuse("it ends after " + std::to_string(at) + " of " + std::to_string(size) + " bytes");
    at += static_cast<std::size_t>(got);
  }
  // Virtual files such as those in /proc report a size of zero.
  if (char more = 0; size == 0 && ::read(file.number(), &more, 1) != 0) return refuse("it is not a regular file");
  return input;
}

std::string require_input(const std::filesystem::path& path, const InputKind& kind, const std::string& what) {
  Input input = read_input(path, kind);
  if (!input.fault.empty()) throw InputError({{path.string(), 0, 0, "cannot read " + what + ": " + input.fault}});
  return std::move(input.bytes);
}

}  // namespace touchstone::scene
