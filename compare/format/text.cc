#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

namespace touchstone::compare {
namespace {

const std::string minus = "−";

/// A quantity in SI units smaller than this is round-off and shown as zero.
constexpr double rounding = 1e-15;

struct Scale {
  double factor;  ///< scaled unit over the given one
  std::string_view name;
  double from = 1.0;  ///< smallest value shown in this unit
};

// From the largest unit to the smallest: the first whose scaled value is at least `from`, else the last.
constexpr Scale lengths[] = {{1e-3, "mm", 0.1}, {1e-6, "µm"}, {1e-9, "nm"}};
constexpr Scale areas[] = {{1e-4, "cm²"}, {1e-6, "mm²"}};
constexpr Scale times[] = {{3600.0, "h"}, {60.0, "min"}, {1.0, "s"}, {1e-3, "ms"}, {1e-6, "µs"}};
constexpr Scale microseconds[] = {{1e6, "s"}, {1e3, "ms"}, {1.0, "µs"}, {1e-3, "ns"}};
constexpr Scale memory[] = {{1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}, {1.0, "bytes"}};

std::span<const Scale> scales(std::string_view unit) {
  if (unit == "m") return lengths;
  if (unit == "m2") return areas;
  if (unit == "s") return times;
  if (unit == "us") return microseconds;
  if (unit == "byte") return memory;
  return {};
}

/// Digits in groups of three with thin spaces, for five digits or more.
std::string grouped(std::string digits) {
  const std::size_t sign = digits.starts_with("-") ? 1 : 0;
  const std::size_t whole = std::min(digits.find('.'), digits.size());
  if (whole - sign < 5) return digits;
  for (std::size_t at = whole; at > sign + 3;) {
    at -= 3;
    digits.insert(at, "\u2009");
  }
  return digits;
}

}  // namespace

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "not finite";
  if (value == 0.0) return "0";
  int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (std::abs(value) * std::pow(10.0, -exponent) >= 10.0 - 0.5 * std::pow(10.0, 1 - digits)) ++exponent;
  if (exponent < -3 || exponent > 6) {
    std::string power;
    for (const char c : std::to_string(exponent)) {
      static constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
      power += c == '-' ? "⁻" : raised[static_cast<std::size_t>(c - '0')];
    }
    return fmt::format("{}{:.{}g} × 10{}", value < 0.0 ? minus : "", std::abs(value) * std::pow(10.0, -exponent),
                       digits, power);
  }
  // A count is printed in full, a measured value with four digits at most.
  if (const int most = std::max(4, digits); exponent >= most && value != std::round(value)) {
    const double unit = std::pow(10.0, exponent + 1 - most);
    value = unit * std::round(value / unit);
  }
  std::string text = fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  text = grouped(text);
  return value < 0.0 ? minus + text.substr(1) : text;
}

std::string thousands_text(int count) {
  return count < 1000 ? std::to_string(count) : fmt::format("{:.0f}k", 1e-3 * count);
}

std::string seconds_text(double time_s) { return fmt::format("{}{}s", number_text(time_s), no_break); }

std::string percent_text(double ratio) {
  if (!std::isfinite(ratio)) return "not finite";
  if (ratio != 0.0 && std::abs(ratio) < least_ratio)
    return fmt::format("below {:.4f}{}%", 100.0 * least_ratio, no_break);
  return fmt::format("{}{}%", number_text(100.0 * ratio), no_break);
}

std::string quantity_text(double value, std::string_view unit) {
  if (!std::isfinite(value)) return "not finite";
  if (unit.empty()) return percent_text(value);
  if (std::abs(value) < rounding) {
    return fmt::format("0{}{}", no_break, unit == "m" ? "mm" : unit == "us" ? "µs" : unit);
  }
  const std::span<const Scale> known = scales(unit);
  if (known.empty()) return fmt::format("{}{}{}", number_text(value), no_break, unit);
  const Scale* best = &known.back();
  for (const Scale& scale : known) {
    if (std::abs(value) >= scale.from * scale.factor) {
      best = &scale;
      break;
    }
  }
  return fmt::format("{}{}{}", number_text(value / best->factor), no_break, best->name);
}

std::string quantity_text(const std::optional<double>& value, std::string_view unit, std::string_view absent) {
  return value && std::isfinite(*value) ? quantity_text(*value, unit) : std::string(absent);
}

std::string wrapped(std::string_view text, std::size_t width) {
  // Continuation bytes of UTF-8 are not counted.
  const auto places = [](std::string_view word) {
    return static_cast<std::size_t>(std::count_if(word.begin(), word.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  };
  std::string out;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t length = places(word);
    if (column > 0 && column + 1 + length > width) {
      out += '\n';
      column = 0;
    } else if (column > 0) {
      out += ' ';
      ++column;
    }
    out += word;
    column += length;
  }
  return out;
}

std::string csv_cell(const std::string& text) {
  double ignored = 0.0;
  const char *begin = text.data() + (text.starts_with('+') ? 1 : 0), *end = text.data() + text.size();
  const bool number = std::from_chars(begin, end, ignored).ptr == end;
  const bool formula = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos && !number;
  std::string told = formula ? "'" + text : text;
  if (told.find_first_of(",\"\r\n") == std::string::npos) return told;
  std::string out = "\"";
  for (const char c : told) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string slug(std::string_view title) {
  std::string out;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  while (out.ends_with('-')) out.pop_back();
  return out;
}

std::string escape_xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // XML does not allow control characters at all.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') out += c;
    }
  }
  return out;
}

}  // namespace touchstone::compare
