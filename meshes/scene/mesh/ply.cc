#include "scene/mesh/mesh_formats.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace touchstone::scene {
namespace {

/// A property of a PLY element; a list if it has a type for its count.
struct Property {
  std::string name, type, count_type;

  [[nodiscard]] bool list() const noexcept { return !count_type.empty(); }
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool text = false, big_endian = false;
  std::vector<Element> elements;
};

bool known_type(std::string_view type) {
  for (const char* name : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint8",
                           "int16", "uint16", "int32", "uint32", "float32", "float64"}) {
    if (type == name) return true;
  }
  return false;
}

Header read_header(TextLines& lines) {
  if (!lines.next() || lines.words()[0] != "ply") lines.fail("expected 'ply' on the first line");
  Header header;
  bool format = false;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "end_header") {
      if (!format) lines.fail("the header names no format");
      for (const Element& element : header.elements) {
        // Rows without properties have no data, however many there are.
        if (element.properties.empty())
          lines.fail("element " + name_or_nothing(element.name) + " has no property; expected at least one");
      }
      return header;
    }
    if (words[0] == "format" && words.size() > 1) {
      header.text = words[1] == "ascii";
      header.big_endian = words[1] == "binary_big_endian";
      if (!header.text && !header.big_endian && words[1] != "binary_little_endian") {
        lines.fail("format '" + shortened(words[1], 40) +
                   "' is not known; expected ascii, binary_little_endian or binary_big_endian");
      }
      format = true;
    } else if (words[0] == "element") {
      const double count = lines.number(2);
      if (count < 0.0 || count > 1e9 || count != std::floor(count))
        lines.fail("the element's count is no whole number");
      header.elements.push_back({std::string(words[1]), static_cast<std::size_t>(count), {}});
    } else if (words[0] == "property") {
      const bool list = words.size() == 5 && words[1] == "list";
      if (header.elements.empty() || (!list && words.size() != 3)) lines.fail("the property cannot be read");
      const Property property = list ? Property{std::string(words[4]), std::string(words[3]), std::string(words[2])}
                                     : Property{std::string(words[2]), std::string(words[1]), ""};
      for (const std::string& type : {property.type, list ? property.count_type : property.type}) {
        if (!known_type(type)) lines.fail("type '" + shortened(type, 40) + "' is not known");
      }
      header.elements.back().properties.push_back(property);
    }
  }
  lines.fail("the header has no end");
}

double take(BinaryReader& reader, const std::string& type) {
  if (type == "char" || type == "int8") return reader.take<std::int8_t>();
  if (type == "uchar" || type == "uint8") return reader.take<std::uint8_t>();
  if (type == "short" || type == "int16") return reader.take<std::int16_t>();
  if (type == "ushort" || type == "uint16") return reader.take<std::uint16_t>();
  if (type == "int" || type == "int32") return reader.take<std::int32_t>();
  if (type == "uint" || type == "uint32") return reader.take<std::uint32_t>();
  if (type == "float" || type == "float32") return reader.take<float>();
  return reader.take<double>();
}

/// Reads the body's numbers in order, from text or binary, with the place of faults.
struct Numbers {
  std::function<void()> begin_row;
  std::function<double(const std::string& type)> take;
  std::function<void(const std::string& message)> fail;
};

void read_vertex(const Element& element, const Numbers& numbers, RawMesh& mesh) {
  Vec3 point = Vec3::Constant(NAN);
  for (const Property& property : element.properties) {
    const double count = property.list() ? numbers.take(property.count_type) : 1.0;
    for (double k = 0.0; k < count; ++k) {
      const double value = numbers.take(property.type);
      for (int axis = 0; axis < 3; ++axis) {
        if (property.name == std::string(1, "xyz"[axis])) point[axis] = value;
      }
    }
  }
  if (!point.allFinite()) numbers.fail("a vertex has no finite x, y and z");
  mesh.points.push_back(point);
}

void read_face(const Element& element, const Numbers& numbers, std::size_t points, RawMesh& mesh) {
  for (const Property& property : element.properties) {
    const double count = property.list() ? numbers.take(property.count_type) : 1.0;
    const bool corners = element.name == "face" && property.list() &&
                         (property.name == "vertex_indices" || property.name == "vertex_index");
    if (corners && count < 3.0) numbers.fail("a face has fewer than three vertices");
    std::vector<std::int32_t> face;
    for (double k = 0.0; k < count; ++k) {
      const double value = numbers.take(property.type);
      if (!corners) continue;
      if (!(value >= 0.0 && value < static_cast<double>(points)) || value != std::floor(value)) {
        numbers.fail(fmt::format("vertex index {:.10g} is out of range; there are {} vertices", value, points));
      }
      face.push_back(static_cast<std::int32_t>(value));
    }
    for (std::size_t k = 2; k < face.size(); ++k) mesh.triangles.push_back({face[0], face[k - 1], face[k]});
  }
}

}  // namespace

RawMesh read_ply(const std::string& bytes, const std::string& name) {
  TextLines lines(bytes, name);
  const Header header = read_header(lines);
  BinaryReader reader(bytes, lines.offset(), header.big_endian, name);
  std::size_t word = 0;
  Numbers numbers;
  if (header.text) {
    numbers.begin_row = [&] {
      if (!lines.next()) lines.fail("the file ends too early");
      word = 0;
    };
    numbers.take = [&](const std::string&) { return lines.number(word++); };
    numbers.fail = [&](const std::string& message) { lines.fail(message); };
  } else {
    numbers.begin_row = [] {};
    numbers.take = [&](const std::string& type) { return take(reader, type); };
    numbers.fail = [&](const std::string& message) { reader.fail(message); };
  }
  std::size_t points = 0;
  for (const Element& element : header.elements) points += element.name == "vertex" ? element.count : 0;
  RawMesh mesh;
  for (const Element& element : header.elements) {
    for (std::size_t row = 0; row < element.count; ++row) {
      numbers.begin_row();
      if (element.name == "vertex") {
        read_vertex(element, numbers, mesh);
      } else {
        // Other elements have no list of vertices and are skipped in the same way.
        read_face(element, numbers, points, mesh);
      }
    }
  }
  return mesh;
}

}  // namespace touchstone::scene
