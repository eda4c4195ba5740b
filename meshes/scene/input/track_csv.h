// Tracks recorded as a table.
#pragma once

#include "scene/base/error.h"
#include "scene/input/fields.h"

#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// Reads a track: a header line with time_s, x_m, y_m, z_m or depth_m and, where the tool turns, qw, qx, qy, qz,
/// in any order; then one row per line. Lines that start with # are passed over. The values' ranges are those of the
/// keys of a [[track]] row.
/// @param name    of the file, for faults
/// @param faults  receives every fault, with line and column; nothing is thrown
/// @param lines   receives the line of each row, for later errors
[[nodiscard]] std::vector<TrackRow> read_track_csv(std::string_view text, const std::string& name,
                                                   std::vector<Fault>& faults, std::vector<int>& lines);

}  // namespace touchstone::scene
