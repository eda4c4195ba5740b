#include "scene/base/csv.h"

#include "scene/base/text.h"

#include <algorithm>

namespace touchstone::scene {
namespace {

/// The text before the first separator; both are removed from `text`.
std::string_view take(std::string_view& text, char separator) {
  const std::string_view part = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(part.size() + 1, text.size()));
  return part;
}

}  // namespace

CsvRows::CsvRows(std::string_view text) noexcept : rest_(without_mark(text)) {}

bool CsvRows::next() {
  if (rest_.empty()) return false;
  text_ = take(rest_, '\n');
  if (text_.ends_with('\r')) text_.remove_suffix(1);
  ++line_;
  cells_.clear();
  std::string_view row = text_;
  cells_.push_back(take(row, ','));
  // A comma is followed by a cell, which may be empty.
  while (cells_.back().data() + cells_.back().size() != text_.data() + text_.size()) cells_.push_back(take(row, ','));
  return true;
}

}  // namespace touchstone::scene
