#include "fast/live/live_log.h"

#include "scene/base/csv.h"
#include "scene/base/error.h"
#include "scene/base/input.h"
#include "scene/base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace touchstone::live {
namespace {

using scene::Vec3;

/// The columns in the order in which they are written.
// clang-format off
enum Column : std::size_t {
  time_s, tick, sequence,
  tool_x, tool_y, tool_z, tool_qw, tool_qx, tool_qy, tool_qz,
  force_x, force_y, force_z, torque_x, torque_y, torque_z,
  model_force_x, model_force_y, model_force_z, model_torque_x, model_torque_y, model_torque_z,
  buttons, status, flags, lateness, force_time, shape_time,
  column_count
};

constexpr std::array<std::string_view, column_count> column_names = {
  "time_s", "tick", "sequence",
  "tool_x_m", "tool_y_m", "tool_z_m", "tool_qw", "tool_qx", "tool_qy", "tool_qz",
  "force_x_n", "force_y_n", "force_z_n", "torque_x_nm", "torque_y_nm", "torque_z_nm",
  "model_force_x_n", "model_force_y_n", "model_force_z_n", "model_torque_x_nm", "model_torque_y_nm", "model_torque_z_nm",
  "buttons", "status", "flags", "lateness_us", "force_us", "shape_us"};
// clang-format on

constexpr std::int64_t counters_max = std::int64_t{1} << 53;  // exact in a double

void append(double value, std::string& text) {
  char number[32];
  text.append(number, std::to_chars(number, number + sizeof number, value).ptr);
}

void append(std::int64_t value, std::string& text) {
  char number[24];
  text.append(number, std::to_chars(number, number + sizeof number, value).ptr);
}

void append(const Vec3& v, std::string& text) {
  for (int axis = 0; axis < 3; ++axis) {
    append(v[axis], text);
    text += ',';
  }
}

/// Position in the file, for error messages.
struct Place {
  const std::filesystem::path& file;
  int line = 0;
  [[noreturn]] void refuse(const std::string& message) const {
    throw scene::InputError(std::vector<scene::Fault>{{file.string(), line, 0, message}});
  }
};

double number_in(std::string_view cell, Column column, const Place& place) {
  const bool free = column >= tool_x && column <= tool_qz;
  const std::optional<double> value = scene::parsed<double>(cell);
  if (!value || !(free || std::isfinite(*value))) {
    place.refuse(std::string(column_names[column]) + " = \"" + scene::shortened(cell, 40) + "\"; expected a " +
                 (free ? "number" : "finite number"));
  }
  return *value;
}

std::int64_t count_in(std::string_view cell, Column column, std::int64_t largest, const Place& place) {
  const std::optional<std::int64_t> value = scene::parsed<std::int64_t>(cell);
  if (!value || *value < 0 || *value > largest) {
    place.refuse(std::string(column_names[column]) + " = \"" + scene::shortened(cell, 40) +
                 "\"; expected a whole number in [0, " + std::to_string(largest) + "]");
  }
  return *value;
}

std::int64_t nanoseconds(double us) { return std::llround(1e3 * std::clamp(us, 0.0, 1e12)); }

}  // namespace

std::string log_header() {
  std::string text;
  for (const std::string_view name : column_names) (text += text.empty() ? "" : ",") += name;
  return text + "\n";
}

void append_log_line(const TickRecord& record, std::string& text) {
  append(record.tick.time_s, text);
  text += ',';
  append(record.tick.index, text);
  text += ',';
  append(record.sequence, text);
  text += ',';
  append(record.pose.position_m, text);
  const Eigen::Quaterniond& q = record.pose.orientation;
  append(q.w(), text);
  text += ',';
  append(Vec3(q.vec()), text);
  for (const Wrench& w : {record.published, record.model}) {
    append(w.force_n, text);
    append(w.torque_nm, text);
  }
  for (const std::uint32_t bits : {record.buttons, record.status, record.flags}) {
    append(static_cast<std::int64_t>(bits), text);
    text += ',';
  }
  append(static_cast<double>(record.lateness_ns) / 1e3, text);
  text += ',';
  append(static_cast<double>(record.force_ns) / 1e3, text);
  text += ',';
  append(static_cast<double>(record.shape_ns) / 1e3, text);
  text += '\n';
}

LiveLog read_log(const std::filesystem::path& file) {
  const std::string content = scene::require_input(file, scene::log_input, "the log");
  Place place{file};
  std::array<std::size_t, column_count> at{};
  std::size_t width = 0;
  LiveLog log;
  for (scene::CsvRows rows(content); rows.next();) {
    place.line = rows.line();
    const std::vector<std::string_view>& cells = rows.cells();
    if (width == 0) {
      width = cells.size();
      for (std::size_t c = 0; c < column_count; ++c) {
        const auto found = std::find(cells.begin(), cells.end(), column_names[c]);
        if (found == cells.end()) {
          place.refuse("no column " + std::string(column_names[c]) + "; expected the header of a live.csv");
        }
        at[c] = static_cast<std::size_t>(found - cells.begin());
      }
      continue;
    }
    if (cells.size() != width) {
      place.refuse(std::to_string(cells.size()) + " values; expected " + std::to_string(width));
    }
    const auto number = [&](Column c) { return number_in(cells[at[c]], c, place); };
    const auto vector = [&](Column x) {
      return Vec3(number(x), number(static_cast<Column>(x + 1)), number(static_cast<Column>(x + 2)));
    };
    const auto count = [&](Column c, std::int64_t largest) { return count_in(cells[at[c]], c, largest, place); };

    TickRecord record;
    record.tick.index = count(tick, counters_max);
    record.tick.time_s = number(time_s);
    record.sequence = count(sequence, counters_max);
    record.pose.position_m = vector(tool_x);
    record.pose.orientation = Eigen::Quaterniond(number(tool_qw), number(tool_qx), number(tool_qy), number(tool_qz));
    record.published = {vector(force_x), vector(torque_x)};
    record.model = {vector(model_force_x), vector(model_torque_x)};
    record.buttons = static_cast<std::uint32_t>(count(buttons, 0xffffffff));
    record.status = static_cast<std::uint32_t>(count(status, 0xffffffff));
    record.flags = static_cast<std::uint32_t>(count(flags, 0xffffffff));
    record.lateness_ns = nanoseconds(number(lateness));
    record.force_ns = nanoseconds(number(force_time));
    record.shape_ns = nanoseconds(number(shape_time));

    const auto expected = static_cast<std::int64_t>(log.ticks.size());
    if (record.sequence != expected) {
      place.refuse("sequence = " + std::to_string(record.sequence) + "; expected " + std::to_string(expected) +
                   " (a log with dropped records cannot be replayed)");
    }
    if (!log.ticks.empty() && record.tick.index <= log.ticks.back().tick.index) {
      place.refuse("tick = " + std::to_string(record.tick.index) + "; expected more than " +
                   std::to_string(log.ticks.back().tick.index));
    }
    if (record.tick.index > 0) {
      if (log.rate_hz == 0) {
        const double rate_hz = static_cast<double>(record.tick.index) / record.tick.time_s;
        if (!(rate_hz > 0.5 && rate_hz < 1e6)) place.refuse("time_s does not fit tick; expected tick / rate");
        log.rate_hz = static_cast<int>(std::lround(rate_hz));
      }
      const double time = static_cast<double>(record.tick.index) / log.rate_hz;
      if (std::abs(record.tick.time_s - time) > 1e-12 * time) {
        std::string message = "time_s = " + scene::shortened(cells[at[time_s]], 40) + " at tick " +
                              std::to_string(record.tick.index) + "; expected ";
        append(time, message);
        place.refuse(message + ", as at " + std::to_string(log.rate_hz) + " Hz");
      }
    }
    log.ticks.push_back(record);
  }
  if (log.ticks.empty()) place.refuse("the log is empty; expected at least one tick");
  return log;
}

}  // namespace touchstone::live
