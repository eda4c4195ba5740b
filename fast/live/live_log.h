// The log of a live run: input of `--device replay`, and a table for pandas.
#pragma once

#include "fast/live/tick_record.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::live {

/// One line of column names, with units, and its end.
[[nodiscard]] std::string log_header();

/// Appends one tick as a line. Numbers are as short as they read back to the same bits.
void append_log_line(const TickRecord& record, std::string& text);

/// A log as read.
struct LiveLog {
  int rate_hz = 0;  ///< of the ticks; 0 where the log is too short
  std::vector<TickRecord> ticks;
};

/// Reads a log back. Columns may be in any order, and unknown ones are skipped.
/// @throws scene::InputError with one fault, the first: file, line, and what was expected. A pose may be anything, as a
///   device may give it; the rest is finite. A log that lacks records (they were dropped) cannot be replayed.
[[nodiscard]] LiveLog read_log(const std::filesystem::path& file);

}  // namespace touchstone::live
