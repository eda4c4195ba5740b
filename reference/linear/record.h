// Plain numbers as bytes, for files and messages. The stored members of a type are in one list, used for both
// directions: `template <class Archive> void serialize(Archive& archive, auto& step) { archive(step.time_s, ...); }`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace touchstone::reference {

/// The value's elements where it is a matrix, a text or another list in one piece, else the value itself.
template <class Value>
auto elements_of(Value& value) {
  const auto plain = [](auto* data, std::size_t size) {
    using Element = std::remove_reference_t<decltype(*data)>;
    static_assert(std::is_trivially_copy_constructible_v<Element> && std::is_trivially_destructible_v<Element>);
    return std::span(data, size);
  };
  if constexpr (requires { value.data(); }) {
    return plain(value.data(), static_cast<std::size_t>(value.size()));
  } else {
    return plain(&value, 1);
  }
}

/// Appends values to a record.
class RecordWriter {
 public:
  static constexpr bool reads = false;

  /// Numbers, structs of them, and the elements of lists. The number of elements is not stored.
  template <class... Values>
  void operator()(const Values&... values) {
    (append(std::as_bytes(elements_of(values))), ...);
  }
  /// The number of elements, as an int.
  void size(const auto& list) { (*this)(static_cast<int>(list.size())); }
  /// The number of elements, and they.
  void sized(const auto&... lists) { ((size(lists), (*this)(lists)), ...); }
  /// A number that the reader must find there.
  void same(int number) { (*this)(number); }
  /// Whether a last part follows, which the reader sees from there being more.
  [[nodiscard]] bool more(bool there) const noexcept { return there; }

  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  void append(std::span<const std::byte> bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  std::string bytes_;
};

/// Sets values from a record that it refers to, in the order in which they were written. All throw std::out_of_range
/// when the record ends too early or holds something else.
class RecordReader {
 public:
  static constexpr bool reads = true;

  explicit RecordReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... Values>
  void operator()(Values&... values) {
    (extract(std::as_writable_bytes(elements_of(values))), ...);
  }
  /// Gives the list its size.
  void size(auto& list) {
    int size = 0;
    (*this)(size);
    // An element has at least a byte.
    require(size >= 0 && static_cast<std::size_t>(size) <= bytes_.size() - place_);
    list.resize(static_cast<std::size_t>(size));
  }
  void sized(auto&... lists) { ((size(lists), (*this)(lists)), ...); }
  void same(int number) {
    int found = 0;
    (*this)(found);
    require(found == number);
  }
  [[nodiscard]] bool more(bool = false) const noexcept { return place_ < bytes_.size(); }

 private:
  static void require(bool right) {
    if (!right) throw std::out_of_range("the record ends too early, or is another one");
  }
  void extract(std::span<std::byte> bytes) {
    require(bytes.size() <= bytes_.size() - place_);
    std::copy_n(bytes_.data() + place_, bytes.size(), reinterpret_cast<char*>(bytes.data()));
    place_ += bytes.size();
  }
  std::string_view bytes_;
  std::size_t place_ = 0;
};

}  // namespace touchstone::reference
