// One line that shows the progress of a piece of work: redrawn in place on a terminal, now and then in a log.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace touchstone::fast {

/// Progress on stderr. On a terminal one line is redrawn, cut to the terminal's width of the moment. Elsewhere, in a
/// file or a pipe, marked lines are printed, and the others at most once a minute.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  /// As the first, on another stream.
  /// @param heartbeat  between two lines that are not marked, where there is no terminal
  ProgressLine(bool quiet, int file_descriptor, std::chrono::steady_clock::duration heartbeat);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// @param text  what matters most first, for the rest may be cut off
  /// @param marked  shown at once, however soon after the one before; the same text twice counts once
  void show(const std::string& text, bool marked = false);
  /// Ends a redrawn line, so that other text may follow.
  void finish();

 private:
  void write(const std::string& text) const;

  bool quiet_, terminal_, open_ = false;
  int file_descriptor_;
  std::chrono::steady_clock::duration heartbeat_;
  std::size_t width_ = 0;  // of the text in the line
  std::string marked_;     // the last text that was
  std::chrono::steady_clock::time_point last_;
};

/// Prints lines about what takes long to stderr.
[[nodiscard]] std::function<void(const std::string&)> progress_lines(bool quiet);

/// The first characters of a text, dots at the end where some are left out. UTF-8; a code point counts as one column.
[[nodiscard]] std::string cut_to_width(const std::string& text, std::size_t columns);

}  // namespace touchstone::fast
