// Text from outside: what is UTF-8, and how it is shown in a message or written in a file without escaping from it.
// Numbers as they are written and read.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace touchstone::scene {

/// Bytes of the UTF-8 character that a text begins with; 0 where it begins with none (RFC 3629).
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// Is the text's first character, of `length` bytes, a control character (C0, DEL or C1)?
[[nodiscard]] bool is_control(std::string_view text, std::size_t length) noexcept;

/// A text that a title or a file name may be: UTF-8 without control characters but tab and line feed.
[[nodiscard]] bool is_plain_text(std::string_view text) noexcept;

/// The text with control characters and bytes that are no UTF-8 made visible, as `\n`, `\u001b` or `\xff`: no terminal
/// acts on it and no line breaks.
[[nodiscard]] std::string visible(std::string_view text);

/// Faults that one message shows at most.
inline constexpr std::size_t faults_shown_max = 40;

/// A value for a message, cut where it is long: "aaaa... (100000 bytes)".
[[nodiscard]] std::string shortened(std::string_view text, std::size_t bytes_max = 200);

/// A word of a file of which it is not known that it is what it should be: in quotes where it is a short plain name,
/// else that it is none, so that a message shows nothing of a file given by mistake.
[[nodiscard]] std::string name_or_nothing(std::string_view word);

/// As a TOML basic string, which reads back the same. @param text  UTF-8
[[nodiscard]] std::string toml_quoted(std::string_view text);

/// Shortest text that reads back as the same double and is a TOML float.
[[nodiscard]] std::string number_text(double value);

/// The number that the whole text is, in the C locale and without blanks; nothing where it is none or out of range.
template <class Number>
[[nodiscard]] std::optional<Number> parsed(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The number rounded to this many significant digits.
[[nodiscard]] double rounded(double value, int digits);

/// Without the byte order mark that some editors put first.
[[nodiscard]] std::string_view without_mark(std::string_view text) noexcept;

}  // namespace touchstone::scene
