// Triangles as read from a file, unchecked: STL, OBJ, PLY.
#pragma once

#include "scene/base/error.h"
#include "scene/base/frames.h"
#include "scene/base/text.h"
#include "scene/mesh/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// Unchecked triangles in the file's own unit: numbers are finite and indices in range, no more.
struct RawMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// By the file's ending: .stl, .obj or .ply, in any case of letters.
/// @throws InputError with the line, or with the byte of a binary file
[[nodiscard]] RawMesh read_mesh(const std::string& bytes, const std::filesystem::path& file);

/// One format each, from the file's bytes. @param name of the file, for faults
[[nodiscard]] RawMesh read_stl(const std::string& bytes, const std::string& name);
[[nodiscard]] RawMesh read_obj(const std::string& bytes, const std::string& name);
[[nodiscard]] RawMesh read_ply(const std::string& bytes, const std::string& name);

/// Lines of a text and the words on them.
class TextLines {
 public:
  TextLines(std::string_view text, std::string name)
      : text_(text), name_(std::move(name)), at_(text.size() - without_mark(text).size()) {}
  /// Steps to the next line that holds words. @returns false at the end
  bool next();
  [[nodiscard]] const std::vector<std::string_view>& words() const noexcept { return words_; }
  [[nodiscard]] int line() const noexcept { return line_; }
  /// Byte after the current line.
  [[nodiscard]] std::size_t offset() const noexcept { return at_; }
  /// The word as a finite number.
  [[nodiscard]] double number(std::size_t word) const;
  /// Three numbers from a word on.
  [[nodiscard]] Vec3 point(std::size_t first_word) const;
  /// @throws InputError at this line
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view text_;
  std::string name_;
  std::size_t at_;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

/// Numbers of a binary file in turn.
class BinaryReader {
 public:
  BinaryReader(std::string_view bytes, std::size_t at, bool big_endian, std::string name)
      : bytes_(bytes), at_(at), big_endian_(big_endian), name_(std::move(name)) {}
  template <class T>
  [[nodiscard]] T take() {
    T value;
    std::array<char, sizeof(T)> raw;
    copy(raw.data(), sizeof(T));
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  void skip(std::size_t count);
  [[nodiscard]] std::size_t offset() const noexcept { return at_; }
  /// @throws InputError at this byte
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void copy(char* to, std::size_t count);

  std::string_view bytes_;
  std::size_t at_;
  bool big_endian_;
  std::string name_;
};

/// Binary STL, coordinates divided by unit_m. @throws InputError when the file cannot be written
void write_stl(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m);

/// OBJ text with shared vertices, coordinates divided by unit_m and rounded to 1e-5 of that unit.
/// @throws InputError when the file cannot be written
void write_obj(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m);

}  // namespace touchstone::scene
