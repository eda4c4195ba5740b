#include "fast/app/new_verb.h"

#include "fast/command/command_line.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/base/nearest_name.h"
#include "scene/input/new_scene.h"
#include "scene/input/scene_io.h"
#include "scene/model/solid_kinds.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iostream>
#include <set>
#include <span>

namespace touchstone::fast {
namespace {

using scene::InputError;
using scene::Vec3;

struct Unit {
  std::string_view name;
  double times, over;  ///< factor, divisor: dividing by a power of ten is exact, multiplying by its inverse is not
};
constexpr std::array length_units = {Unit{"um", 1.0, 1e6}, Unit{"mm", 1.0, 1e3}, Unit{"cm", 1.0, 1e2},
                                     Unit{"m", 1.0, 1.0}, Unit{"in", 0.0254, 1.0}};
constexpr std::array stress_units = {Unit{"Pa", 1.0, 1.0}, Unit{"kPa", 1e3, 1.0}, Unit{"MPa", 1e6, 1.0},
                                     Unit{"GPa", 1e9, 1.0}};

/// A number and the text after it; nothing if the text does not begin with a number.
std::optional<std::pair<double, std::string_view>> number_and_rest(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  return std::pair(value, rest);
}

const Unit* unit_of(std::string_view name, std::span<const Unit> units) {
  const auto found = std::ranges::find(units, name, &Unit::name);
  return found == units.end() ? nullptr : &*found;
}

/// A shape's name and the meaning of its lengths.
struct ShapeWords {
  std::string_view name;
  std::size_t count;
  std::string_view lengths;
};
constexpr std::array tool_shapes = {ShapeWords{"sphere", 1, "its radius, such as 10mm"},
                                    ShapeWords{"capsule", 2, "radius and length of the straight part, such as 6x20mm"},
                                    ShapeWords{"cylinder", 2, "radius and length, such as 6x20mm"},
                                    ShapeWords{"box", 3, "three edge lengths, such as 10x10x20mm"},
                                    ShapeWords{"mesh", 0, "a file, such as tool.stl"}};

const ShapeWords& shape_of(const std::vector<std::string>& given, std::span<const ShapeWords> shapes,
                           const std::string& option) {
  const auto found = std::ranges::find(shapes, given.at(0), &ShapeWords::name);
  if (found != shapes.end()) return *found;
  std::vector<std::string> names;
  std::string all;
  for (const ShapeWords& shape : shapes) {
    names.emplace_back(shape.name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  throw InputError(option + " " + given.at(0) + ": did you mean \"" + scene::nearest_name(given.at(0), names) +
                   "\"? Expected one of " + all);
}

std::vector<double> sizes_m(const std::vector<std::string>& given, const ShapeWords& shape, const std::string& option) {
  std::vector<double> sizes = lengths_m(given.at(1), option + " " + given.at(0));
  if (sizes.size() != shape.count || std::ranges::any_of(sizes, [](double m) { return m <= 0.0; })) {
    throw InputError(option + " " + given.at(0) + " " + given.at(1) + ": expected " + std::string(shape.lengths));
  }
  return sizes;
}

std::vector<ShapeWords> body_shapes() {
  std::vector<ShapeWords> out;
  for (const scene::SolidKind& kind : scene::solid_kinds()) {
    std::size_t count = 0;
    for (const scene::SolidLength& length : kind.lengths) {
      count += std::holds_alternative<Vec3 scene::Solid::*>(length) ? 3 : 1;
    }
    if (!kind.lengths_text.empty()) out.push_back({kind.word, count, kind.lengths_text});
  }
  return out;
}

scene::Body body_of(const std::vector<std::string>& given) {
  const std::vector<ShapeWords> shapes = body_shapes();
  const ShapeWords& shape = shape_of(given, shapes, "--body");
  const std::vector<double> m = sizes_m(given, shape, "--body");
  scene::Body body;
  const scene::SolidKind& kind = *std::ranges::find(scene::solid_kinds(), shape.name, &scene::SolidKind::word);
  body.shape = kind.shape;
  if (kind.named()) body.named = kind.word;
  auto next = m.begin();
  for (const scene::SolidLength& length : kind.lengths) {
    if (const auto* one = std::get_if<double scene::Solid::*>(&length)) body.*(*one) = *next++;
    if (const auto* three = std::get_if<Vec3 scene::Solid::*>(&length)) {
      for (double& component_m : body.*(*three)) component_m = *next++;
    }
  }
  scene::complete(body);
  return body;
}

scene::Tool tool_of(const NewOptions& options) {
  const std::vector<std::string>& given = options.tool;
  const ShapeWords& shape = shape_of(given, tool_shapes, "--tool");
  scene::Tool tool;
  if (shape.name == "mesh") {
    constexpr std::array units = {"m", "cm", "mm", "in"};
    const auto unit = std::ranges::find(units, options.unit);
    if (unit == units.end()) {
      throw InputError((options.unit.empty() ? "--unit is missing" : "--unit " + options.unit) +
                       ": expected the unit of the mesh file's coordinates: m, cm, mm or in");
    }
    tool.shape = scene::ToolShape::mesh;
    tool.unit = static_cast<scene::LengthUnit>(unit - units.begin());
    const std::filesystem::path from = std::filesystem::absolute(options.file).parent_path();
    tool.file = std::filesystem::absolute(given.at(1)).lexically_normal().lexically_relative(from.lexically_normal());
    return tool;
  }
  if (!options.unit.empty()) throw InputError("--unit only applies to --tool mesh FILE");
  const std::vector<double> m = sizes_m(given, shape, "--tool");
  if (shape.name == "box") {
    tool.shape = scene::ToolShape::box;
    tool.size_m = Vec3(m[0], m[1], m[2]);
    return tool;
  }
  tool.shape = shape.name == "sphere"    ? scene::ToolShape::sphere
               : shape.name == "capsule" ? scene::ToolShape::capsule
                                         : scene::ToolShape::cylinder;
  tool.radius_m = m[0];
  if (m.size() > 1) tool.length_m = m[1];
  return tool;
}

/// An option that gives one of the shapes and its lengths.
void add_shape(Command& verb, const std::string& option, std::vector<std::string>& values,
               std::span<const ShapeWords> shapes) {
  std::string words, names;
  for (const ShapeWords& shape : shapes) {
    words.append(words.empty() ? "" : "; ").append(shape.name).append(" and ").append(shape.lengths);
    names.append(names.empty() ? "" : "|").append(shape.name);
  }
  verb.option(option, values, words).required().values(2).type(names + " SIZE");
}

double largest_m(const scene::Bounds& bounds) { return (bounds.upper_m - bounds.lower_m).maxCoeff(); }

/// Refuses values that are in range but most likely a mistake.
void require_likely(const scene::Scene& loaded, const scene::NewScene& asked) {
  const double height_m = scene::body_shape(loaded.body)->bounds().upper_m.z();
  if (asked.depth_m > 0.5 * height_m) {
    throw InputError("--depth: more than half of the body's height; expected at most " +
                     std::to_string(500.0 * height_m) + "mm");
  }
  if (!loaded.tool.mesh) return;
  const double tool_m = largest_m(loaded.tool.mesh->bounds());
  const double ratio = tool_m / largest_m(scene::body_shape(loaded.body)->bounds());
  if (ratio > 100.0 || ratio < 1e-3) {
    throw InputError("--unit: the mesh is " + std::to_string(1e3 * tool_m) +
                     " mm long, which does not suit the body's size; expected the unit of the file's coordinates");
  }
}

}  // namespace

double length_m(const std::string& text, const std::string& option) {
  const auto parts = number_and_rest(text);
  const Unit* unit = parts ? unit_of(parts->second, length_units) : nullptr;
  if (unit == nullptr) {
    throw InputError(option + " " + text + ": expected a length with its unit, um, mm, cm, m or in, such as 3mm");
  }
  return parts->first * unit->times / unit->over;
}

std::vector<double> lengths_m(const std::string& text, const std::string& option) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == 'x' || c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  std::string unit;
  std::vector<double> lengths;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    const auto number = number_and_rest(*part);
    if (number && number->second.empty()) *part += unit;
    if (number && !number->second.empty()) unit = number->second;
    lengths.insert(lengths.begin(), length_m(*part, option));
  }
  return lengths;
}

double stress_pa(const std::string& text, const std::string& option) {
  const auto parts = number_and_rest(text);
  const Unit* unit = parts ? unit_of(parts->second, stress_units) : nullptr;
  if (unit == nullptr) {
    throw InputError(option + " " + text + ": expected a number with its unit, Pa, kPa, MPa or GPa, such as 3MPa");
  }
  return parts->first * unit->times;
}

int write_new_scene(const NewOptions& options, const std::string& program) {
  if (options.file.extension() != ".toml") {
    throw InputError(options.file.string() + ": expected a file name that ends in .toml");
  }
  if (std::filesystem::exists(options.file)) {
    throw InputError(options.file.string() + ": the file exists already; expected a new name");
  }
  const std::filesystem::path folder = std::filesystem::absolute(options.file).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(options.file.string() + ": expected an existing folder, and there is no " + folder.string());
  }
  scene::NewScene asked;
  asked.body = body_of(options.body);
  asked.body.material = {stress_pa(options.youngs_modulus, "--youngs-modulus"), options.poissons_ratio};
  asked.tool = tool_of(options);
  asked.depth_m = length_m(options.depth, "--depth");
  if (asked.depth_m <= 0.0) throw InputError("--depth " + options.depth + ": expected a length above 0");
  if (!options.place.empty()) {
    const std::vector<double> place_m = lengths_m(options.place, "--at");
    if (place_m.size() != 2) throw InputError("--at " + options.place + ": expected x and y, such as 10x5mm");
    asked.place_m = {place_m[0], place_m[1]};
  }
  if (!options.slide.empty()) asked.slide_m = length_m(options.slide, "--slide");
  asked.friction = options.friction;
  asked.title = options.title.empty() ? "A " + options.tool.at(0) + " pressed on a " + options.body.at(0) +
                                            (asked.slide_m != 0.0 ? " and moved along it" : "")
                                      : options.title;
  const std::string text = scene::new_scene_toml(asked, options.file.filename().string());
  try {
    require_likely(scene::parse_scene(text, options.file), asked);
  } catch (const InputError& error) {
    // The faults have no line numbers, since the file does not exist yet, and all rows of the track have the same
    // faults.
    std::vector<scene::Fault> faults;
    std::set<std::string> told;
    for (scene::Fault fault : error.faults()) {
      if (fault.file == options.file.string()) fault = {"", 0, 0, fault.message};
      if (const std::size_t row = fault.message.find("].");
          fault.message.starts_with("track[") && row != std::string::npos)
        fault.message.erase(0, row + 2);
      if (told.insert(fault.text()).second) faults.push_back(fault);
    }
    throw InputError(std::move(faults));
  }
  scene::write_file(options.file, text);
  std::cout << "Scene: " << options.file.string() << "\nNext:\n  " << program << " plan " << options.file.string()
            << "\n  " << program << (program == "touchstone-fast" ? " fast " : " compare ") << options.file.string()
            << '\n';
  return done;
}

Command add_new_verb(Command& program, NewOptions& options) {
  Command verb = program.add("new", "write a commented scene file from sizes, material and depth");
  verb.option("FILE", options.file, "scene file to write (.toml); never overwritten").required();
  add_shape(verb, "--body", options.body, body_shapes());
  verb.option("--youngs-modulus", options.youngs_modulus, "E of the body, such as 3MPa").required().type("STRESS");
  verb.option("--poissons-ratio", options.poissons_ratio, "nu of the body, 0 to 0.5").required().range(0.0, 0.5);
  add_shape(verb, "--tool", options.tool, tool_shapes);
  verb.option("--unit", options.unit, "unit of a mesh tool's coordinates").type("m|cm|mm|in");
  verb.option("--depth", options.depth, "how far the tool moves beyond first contact, such as 3mm")
      .required()
      .type("LENGTH");
  verb.option("--at", options.place, "x and y of first contact, such as 10x5mm (default the middle)")
      .type("LENGTHxLENGTH");
  verb.option("--slide", options.slide, "how far it then moves along x, such as 10mm (default 0)").type("LENGTH");
  verb.option("--friction", options.friction, "Coulomb friction coefficient (default frictionless)").range(0.0, 10.0);
  verb.option("--title", options.title, "title for reports").type("WORDS");
  verb.example(
      "new block.toml --body box 60x60x40mm --youngs-modulus 3MPa --poissons-ratio 0.45 \\\n"
      "    --tool capsule 6x20mm --depth 3mm --at 10x5mm --friction 0.3");
  verb.action([&options, name = program.program_name()] { return write_new_scene(options, name); });
  return verb;
}

}  // namespace touchstone::fast
