// Numbers and words as the report prints them, with a no-break space between number and unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace touchstone::compare {

/// Between a number and its unit, so that no line ends there.
inline constexpr std::string_view no_break = "\u00a0";

/// Three significant digits: "0.34", "170", "3 × 10⁸"; before the point four, and a count whole: "3952", "21 600".
/// "not finite" for NaN and infinity.
[[nodiscard]] std::string number_text(double value, int digits = 3);

/// A ratio smaller than this is round-off or the tolerance of a solver.
inline constexpr double least_ratio = 1e-6;

/// A ratio as a percentage, "99.6 %"; "below 0.0001 %" where it is below the accuracy of every figure here.
[[nodiscard]] std::string percent_text(double ratio);

/// A count in thousands from a thousand on: "400", "4k".
[[nodiscard]] std::string thousands_text(int count);

/// A value in its unit, scaled to what is read easily: (0.005, "m") gives "5 mm". Known to scale: m, m2, s, us,
/// byte; a ratio has the unit "" and is given as a percentage. With a unit, less than 1e-15 is rounding and given as 0.
[[nodiscard]] std::string quantity_text(double value, std::string_view unit);

/// The same, or a word for a value that is absent or not finite.
[[nodiscard]] std::string quantity_text(const std::optional<double>& value, std::string_view unit,
                                        std::string_view absent);

/// "0.5 s", whatever its size.
[[nodiscard]] std::string seconds_text(double time_s);

/// Broken into lines of at most `width` characters at spaces.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width = 100);

/// A text as a cell of a CSV file (RFC 4180). One that a spreadsheet would take for a formula gets an apostrophe first,
/// as spreadsheets write a text themselves; a number does not.
[[nodiscard]] std::string csv_cell(const std::string& text);

/// A title as part of a dotted key or as an anchor of a page: "Force, over time" is "force-over-time".
[[nodiscard]] std::string slug(std::string_view title);

/// For text and attributes of HTML, SVG and XML.
[[nodiscard]] std::string escape_xml(std::string_view text);

}  // namespace touchstone::compare
