#include "scene/mesh/mesh_formats.h"

#include "scene/base/error.h"
#include "scene/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>

namespace touchstone::scene {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t stl_header = 84, stl_facet = 50;

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw InputError({{name, 0, 0, message}});
}

RawMesh read_stl_text(const std::string& bytes, const std::string& name) {
  RawMesh mesh;
  TextLines lines(bytes, name);
  std::int32_t corners = 0;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "vertex") {
      if (++corners > 3) lines.fail("a facet has more than three vertices; expected triangles");
      mesh.points.push_back(lines.point(1));
    } else if (words[0] == "endloop") {
      if (corners != 3) lines.fail("a facet has " + std::to_string(corners) + " vertices; expected 3");
      const auto last = static_cast<std::int32_t>(mesh.points.size()) - 1;
      mesh.triangles.push_back({last - 2, last - 1, last});
      corners = 0;
    } else if (words[0] != "solid" && words[0] != "facet" && words[0] != "outer" && words[0] != "endfacet" &&
               words[0] != "endsolid") {
      lines.fail("a line begins with a word " + name_or_nothing(words[0]) + "; expected one of STL text, as vertex");
    }
  }
  if (corners != 0) lines.fail("the file ends within a facet");
  return mesh;
}

/// One corner of an OBJ face: i, i/j, i//k or i/j/k; counted from 1, or with a minus back from the last point.
std::int32_t obj_index(const TextLines& lines, std::string_view word, std::size_t points) {
  const std::string_view digits = word.substr(0, word.find('/'));
  const std::optional<long> index = parsed<long>(digits);
  if (!index) lines.fail("'" + shortened(word, 40) + "' is not a vertex index");
  const long place = *index < 0 ? static_cast<long>(points) + *index : *index - 1;
  if (*index == 0 || place < 0 || place >= static_cast<long>(points)) {
    lines.fail("vertex index " + std::to_string(*index) + " is out of range; there are " + std::to_string(points) +
               " vertices so far");
  }
  return static_cast<std::int32_t>(place);
}

}  // namespace

bool TextLines::next() {
  words_.clear();
  while (words_.empty() && at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view rest = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++line_;
    while (true) {
      const std::size_t begin = rest.find_first_not_of(" \t\r\v\f");
      if (begin == std::string_view::npos) break;
      rest.remove_prefix(begin);
      const std::size_t length = std::min(rest.find_first_of(" \t\r\v\f"), rest.size());
      words_.push_back(rest.substr(0, length));
      rest.remove_prefix(length);
    }
  }
  return !words_.empty();
}

double TextLines::number(std::size_t word) const {
  if (word >= words_.size()) fail("the line is too short, expected a number");
  std::string_view digits = words_[word];
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const std::optional<double> value = parsed<double>(digits);
  if (!value) fail("'" + shortened(words_[word], 40) + "' is not a number");
  if (!std::isfinite(*value)) fail("a coordinate is not finite: '" + shortened(words_[word], 40) + "'");
  return *value;
}

Vec3 TextLines::point(std::size_t first_word) const {
  return {number(first_word), number(first_word + 1), number(first_word + 2)};
}

void TextLines::fail(const std::string& message) const { throw InputError({{name_, line_, 0, message}}); }

void BinaryReader::copy(char* to, std::size_t count) {
  if (count > bytes_.size() - at_) {
    at_ = bytes_.size();
    fail("the file ends too early");
  }
  std::memcpy(to, bytes_.data() + at_, count);
  if (big_endian_) std::reverse(to, to + count);
  at_ += count;
}

void BinaryReader::skip(std::size_t count) {
  if (count > bytes_.size() - at_) {
    at_ = bytes_.size();
    fail("the file ends too early");
  }
  at_ += count;
}

void BinaryReader::fail(const std::string& message) const {
  throw InputError({{name_, 0, 0, "byte " + std::to_string(at_) + ": " + message}});
}

RawMesh read_stl(const std::string& bytes, const std::string& name) {
  // Many binary files start with "solid" too, so the size decides; a text has no zero byte.
  std::size_t expected = stl_header;
  if (bytes.size() >= stl_header) {
    BinaryReader count(bytes, stl_header - 4, false, name);
    expected += stl_facet * static_cast<std::size_t>(count.take<std::uint32_t>());
  }
  if (bytes.size() != expected) {
    const std::string_view text = without_mark(bytes);
    const bool is_text =
        text.find('\0') == std::string::npos && text.find("solid") < text.find_first_not_of(" \t\r\n") + 1;
    if (is_text) return read_stl_text(bytes, name);
    fail(name, "byte " + std::to_string(bytes.size()) + ": the file ends here; its count of triangles asks for " +
                   std::to_string(expected) + " bytes");
  }
  RawMesh mesh;
  BinaryReader reader(bytes, stl_header, false, name);
  while (reader.offset() < bytes.size()) {
    reader.skip(3 * sizeof(float));
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = reader.take<float>();
        if (!std::isfinite(p[axis])) reader.fail("a coordinate is not finite");
      }
      mesh.points.push_back(p);
    }
    reader.skip(2);
    const auto last = static_cast<std::int32_t>(mesh.points.size()) - 1;
    mesh.triangles.push_back({last - 2, last - 1, last});
  }
  return mesh;
}

RawMesh read_obj(const std::string& bytes, const std::string& name) {
  RawMesh mesh;
  TextLines lines(bytes, name);
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "v") {
      mesh.points.push_back(lines.point(1));
    } else if (words[0] == "f") {
      if (words.size() < 4) lines.fail("a face has fewer than three vertices");
      const auto corner = [&](std::size_t word) { return obj_index(lines, words[word], mesh.points.size()); };
      for (std::size_t k = 3; k < words.size(); ++k) {
        mesh.triangles.push_back({corner(1), corner(k - 1), corner(k)});
      }
    }
  }
  return mesh;
}

RawMesh read_mesh(const std::string& bytes, const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".stl") return read_stl(bytes, name);
  if (ending == ".obj") return read_obj(bytes, name);
  if (ending == ".ply") return read_ply(bytes, name);
  fail(name, "ending '" + ending + "' is not known; expected .stl, .obj or .ply");
}

void write_stl(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m) {
  std::string bytes = "binary STL, touchstone";
  bytes.resize(stl_header - 4, ' ');
  const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto put_point = [&](const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(p[axis]));
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 pa = mesh.points_m.col(a) / unit_m, pb = mesh.points_m.col(b) / unit_m,
               pc = mesh.points_m.col(c) / unit_m;
    put_point((pb - pa).cross(pc - pa).normalized());
    for (const Vec3& p : {pa, pb, pc}) put_point(p);
    put(std::uint16_t{0});
  }
  std::ofstream out(file, std::ios::binary);
  if (!out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    fail(file.string(), "cannot be written");
}

void write_obj(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m) {
  std::ofstream out(file, std::ios::binary);
  for (Eigen::Index i = 0; i < mesh.points_m.cols(); ++i) {
    // Adding zero turns -0 into 0.
    const Vec3 p = (mesh.points_m.col(i) / unit_m * 1e5).array().round() / 1e5 + 0.0;
    out << fmt::format("v {:.10g} {:.10g} {:.10g}\n", p.x(), p.y(), p.z());
  }
  for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  if (!out.flush()) fail(file.string(), "cannot be written");
}

}  // namespace touchstone::scene
