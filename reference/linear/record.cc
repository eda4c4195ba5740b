#include "reference/linear/record.h"

#include <cstring>
#include <stdexcept>

namespace touchstone::reference {

void Record::put(std::string_view text) {
  put(static_cast<int>(text.size()));
  append(text.data(), text.size());
}

void Record::append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

void Record::extract(void* data, std::size_t size) {
  if (size > bytes_.size() - place_) throw std::out_of_range("the record ends too early");
  std::memcpy(data, bytes_.data() + place_, size);
  place_ += size;
}

double Record::take_double() {
  double value;
  extract(&value, sizeof value);
  return value;
}

int Record::take_int() {
  int value;
  extract(&value, sizeof value);
  return value;
}

std::string Record::take_text() {
  const int size = take_int();
  if (size < 0 || static_cast<std::size_t>(size) > bytes_.size() - place_) throw std::out_of_range("not a text");
  std::string text(static_cast<std::size_t>(size), '\0');
  extract(text.data(), text.size());
  return text;
}

}  // namespace touchstone::reference
