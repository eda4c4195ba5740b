#include "fast/command/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iostream>

namespace touchstone::fast {
namespace {

constexpr std::size_t usual_columns = 80;

std::size_t columns_of(int file_descriptor) {
  winsize size{};
  return ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual_columns;
}

/// Whether a byte begins a code point.
bool begins(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins));
}

}  // namespace

std::string cut_to_width(const std::string& text, std::size_t columns) {
  if (width_of(text) <= columns) return text;
  const std::string dots(std::min<std::size_t>(3, columns), '.');
  std::size_t end = 0;
  for (std::size_t width = 0; end < text.size(); ++end) {
    if (begins(text[end]) && width++ == columns - dots.size()) break;
  }
  return text.substr(0, end) + dots;
}

ProgressLine::ProgressLine(bool quiet) : ProgressLine(quiet, STDERR_FILENO, std::chrono::minutes(1)) {}

ProgressLine::ProgressLine(bool quiet, int file_descriptor, std::chrono::steady_clock::duration heartbeat)
    : quiet_(quiet),
      terminal_(isatty(file_descriptor) == 1),
      file_descriptor_(file_descriptor),
      heartbeat_(heartbeat),
      last_(terminal_ ? std::chrono::steady_clock::time_point() : std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() { finish(); }

void ProgressLine::write(const std::string& text) const {
  // A failure to show progress does not end the work.
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file_descriptor_, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    done += static_cast<std::size_t>(written);
  }
}

void ProgressLine::show(const std::string& text, bool marked) {
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  if (marked && !terminal_) {
    if (text == marked_) return;
    marked_ = text;
  }
  if (!marked && now - last_ < (terminal_ ? std::chrono::milliseconds(50) : heartbeat_)) return;
  last_ = now;
  if (!terminal_) {
    write(text + '\n');
    return;
  }
  // The last column stays empty: some terminals begin a new line when it is written.
  const std::size_t columns = std::max<std::size_t>(columns_of(file_descriptor_), 2) - 1;
  const std::string line = cut_to_width(text, columns);
  const std::size_t width = width_of(line);
  // Overwrites the rest of a longer line with blanks.
  const std::size_t left_behind = std::min(width_, columns);
  write('\r' + line + std::string(left_behind > width ? left_behind - width : 0, ' '));
  width_ = width;
  open_ = true;
}

void ProgressLine::finish() {
  if (open_) write("\n");
  open_ = false;
  width_ = 0;
}

std::function<void(const std::string&)> progress_lines(bool quiet) {
  return [quiet](const std::string& line) {
    if (!quiet) std::cerr << line << '\n';
  };
}

}  // namespace touchstone::fast
