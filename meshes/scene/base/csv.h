// Tables as text: a row per line, its cells between commas.
#pragma once

#include <string_view>
#include <vector>

namespace touchstone::scene {

/// The rows of a table, one after the other: `while (rows.next())`. A byte order mark at the beginning and a carriage
/// return at the end of a line are no part of them. Refers to the text.
class CsvRows {
 public:
  explicit CsvRows(std::string_view text) noexcept;

  /// Goes to the next row, the first one at the beginning. @returns false at the end
  bool next();

  [[nodiscard]] std::string_view text() const noexcept { return text_; }
  [[nodiscard]] const std::vector<std::string_view>& cells() const noexcept { return cells_; }  ///< at least one
  [[nodiscard]] int line() const noexcept { return line_; }                                     ///< 1-based
  /// Where a part of the row begins, in bytes, 1-based.
  [[nodiscard]] int column(std::string_view part) const noexcept {
    return static_cast<int>(part.data() - text_.data()) + 1;
  }

 private:
  std::string_view rest_, text_;
  std::vector<std::string_view> cells_;
  int line_ = 0;
};

}  // namespace touchstone::scene
