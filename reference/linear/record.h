// Plain numbers as bytes, for files and messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace touchstone::reference {

/// Bytes, appended and taken in the same order.
class Record {
 public:
  Record() = default;
  explicit Record(std::string bytes) : bytes_(std::move(bytes)) {}

  void put(double value) { append(&value, sizeof value); }
  void put(int value) { append(&value, sizeof value); }
  void put(std::string_view text);
  /// Any contiguous range of plain numbers; its length is not stored.
  template <class Number>
  void put(const Number* values, std::size_t count) {
    append(values, count * sizeof(Number));
  }

  /// @throws std::out_of_range when the record ends too early, for all of these
  [[nodiscard]] double take_double();
  [[nodiscard]] int take_int();
  [[nodiscard]] std::string take_text();
  template <class Number>
  void take(Number* values, std::size_t count) {
    extract(values, count * sizeof(Number));
  }
  [[nodiscard]] bool at_end() const noexcept { return place_ == bytes_.size(); }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  void append(const void* data, std::size_t size);
  void extract(void* data, std::size_t size);
  std::string bytes_;
  std::size_t place_ = 0;
};

}  // namespace touchstone::reference
