#include "scene/input/new_scene.h"

#include "scene/base/index.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/model/area_law.h"
#include "scene/model/solid_kinds.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace touchstone::scene {
namespace {

/// In the usual notation: 3.0e6 instead of 3e+06.
std::string plain(double value) {
  const double size = std::abs(value);
  if (size == 0.0 || (size >= 1e-4 && size < 1e5)) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr;
    std::string out(text.data(), end);
    return out.find('.') == std::string::npos ? out + ".0" : out;
  }
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  std::string out(text.data(), end);
  const std::size_t e = out.find('e');
  std::string digits = out.substr(0, e);
  if (digits.find('.') == std::string::npos) digits += ".0";
  return digits + "e" + std::to_string(std::atoi(out.c_str() + e + 1));
}

std::string list(std::initializer_list<double> values) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "" : ", ") + plain(value);
  return "[" + out + "]";
}

std::string list(const Vec3& v) { return list({v.x(), v.y(), v.z()}); }

std::string line(const std::string& text, const std::string& comment) {
  return text + std::string(text.size() < 34 ? 34 - text.size() : 1, ' ') + "# " + comment + "\n";
}

std::string body_text(const Body& body) {
  std::string out =
      line("shape = " + toml_quoted(kind_of(body).word), "its lowest point is at z = 0, its middle on the z axis");
  Inclusion solid;  // whose keys have no prefix
  static_cast<Solid&>(solid) = body;
  for (const Field<Inclusion>& field : inclusion_fields()) {
    if (!field.only_when || !applies(field, solid) || !must_be_given(field)) continue;
    std::string comment(field.doc.substr(0, field.doc.size() - 1));  // without its full stop
    comment.front() = static_cast<char>(std::tolower(comment.front()));
    out += line(std::string(field.key) + " = " + value_text(field, solid), comment);
  }
  return out;
}

std::string tool_text(const Tool& tool) {
  constexpr std::array<const char*, 4> units = {"m", "cm", "mm", "in"};
  switch (tool.shape) {
    case ToolShape::sphere:
      return "shape = \"sphere\"\nradius_m = " + plain(tool.radius_m) + "\n";
    case ToolShape::capsule:
      return line("shape = \"capsule\"", "upright, along its own z axis") + "radius_m = " + plain(tool.radius_m) +
             "\n" + line("length_m = " + plain(tool.length_m), "of the straight part");
    case ToolShape::cylinder:
      return line("shape = \"cylinder\"", "upright, along its own z axis") + "radius_m = " + plain(tool.radius_m) +
             "\n" + line("length_m = " + plain(tool.length_m), "from end to end");
    case ToolShape::box:
      return "shape = \"box\"\n" + line("size_m = " + list(tool.size_m), "edge lengths along x, y and z");
    case ToolShape::mesh:
      return line("shape = \"mesh\"", "a closed triangle mesh, in the file's own axes") +
             line("file = \"" + tool.file + "\"", "from this file's folder; .stl, .obj or .ply") +
             line(std::string("unit = \"") + nth(units, tool.unit) + "\"",
                  "of the file's coordinates: m, cm, mm or in");
  }
  return "";
}

bool flat(const Tool& tool) { return tool.shape == ToolShape::cylinder || tool.shape == ToolShape::box; }

std::string row(const std::string& comment, double time_s, const Eigen::Vector2d& place_m, double depth_m) {
  return "[[track]]" + std::string(25, ' ') + "# " + comment + "\ntime_s = " + plain(time_s) +
         "\nposition_m = " + list({place_m.x(), place_m.y()}) + "\ndepth_m = " + plain(depth_m) + "\n\n";
}

}  // namespace

std::string new_scene_toml(const NewScene& scene, const std::string& name) {
  const Body& body = scene.body;
  const Tool& tool = scene.tool;
  Scene titled;
  titled.title = scene.title;
  std::string out =
      "# A scene: an elastic body, a rigid tool, and the track on which the tool moves.\n"
      "# Lengths are in metres, and every key ends in its unit.\n"
      "#   touchstone plan    " +
      name +
      "   what each model computes for it\n"
      "#   touchstone fast    " +
      name +
      "   the real-time model alone\n"
      "#   touchstone compare " +
      name +
      "   its errors against the finite element reference\n"
      "# Any key can be changed for one run: --set body.material.poissons_ratio=0.3\n"
      "# touchstone --scene-reference prints all keys.\n"
      "title = " +
      value_text(scene_fields().front(), titled) + "\n\n[body]\n" + body_text(body);
  if (body.flat_bottom()) {
    out += line("support = \"bottom\"", "the bottom face is fixed");
  } else {
    const double height_m = body_shape(body)->bounds().upper_m.z();
    out += line("support_height_m = " + plain(rounded(0.1 * height_m, 3)), "the surface below it is fixed");
  }
  const Material& material = body.material;
  out += "\n[body.material]\n" + line("youngs_modulus_pa = " + plain(material.youngs_modulus_pa), "E") +
         line("poissons_ratio = " + plain(material.poissons_ratio), "nu; exactly 0.5 is incompressible") +
         "\n[tool]\n" + tool_text(tool) + "\n";

  out +=
      "# The tool's poses over time. depth_m is how far the tool has moved down since it first\n"
      "# touched the body at position_m = [x, y]; negative is that far above. A pose can be given\n"
      "# by its height instead: position_m = [x, y, z] without depth_m.\n" +
      row("above the body", 0.0, scene.place_m, rounded(-0.2 * scene.depth_m, 6)) +
      row("pressed in", 1.0, scene.place_m, scene.depth_m);
  if (scene.slide_m != 0.0) {
    const Eigen::Vector2d end_m(rounded(scene.place_m.x() + scene.slide_m, 12), scene.place_m.y());
    out += row("moved along x at that depth", 2.0, end_m, scene.depth_m);
  }

  out +=
      "# The fast model's force for a depth; the reference does not use it. The area-aware law is\n"
      "#   F = k1 D,  k1 = k1_per_radius_n_per_m2 * a,  a = sqrt(A / pi),\n"
      "# with the contact's area A and the mean depth D over it. For a thick body the constant\n"
      "# follows from the material, without a fit: 2 E / (1 - nu^2) under a flat tool and\n"
      "# 0.707 of it under a rounded one, which is Hertz's force.\n"
      "# Here it is 2 * " +
      plain(material.youngs_modulus_pa) + " / (1 - " + plain(material.poissons_ratio) + "^2)" +
      (flat(tool) ? "" : " * 0.707") + ".\n" +
      (tool.shape == ToolShape::mesh
           ? "# The mesh is assumed to be rounded; if it meets the body with a flat face, leave out\n"
             "# the 0.707.\n"
           : "") +
      "[contact]\nlaw = \"area_aware\"\nk1_per_radius_n_per_m2 = " +
      plain(area_law_constant_n_per_m2(material, tool, Formulation::corrected)) + "\n" +
      line("k3_n_per_m3 = 0.0", "a cubic term, which \"touchstone tune\" can fit") + "\n";

  const std::string mark = scene.friction ? "" : "# ";
  const std::string mu = plain(scene.friction.value_or(0.3));
  out += (scene.friction ? "# Coulomb friction with the coefficient " + mu + ": K = mu, beta = 1, mu_D = mu.\n"
                         : "# No friction. Coulomb friction with the coefficient " + mu +
                               " would be these lines\n# without their first sign: K = mu, beta = 1, mu_D = mu.\n") +
         mark + "[contact.friction]\n" + mark + line("K = " + mu, "sticking up to K F_n^beta") + mark + "beta = 1.0\n" +
         mark + line("mu_D = " + mu, "slipping at mu_D F_n");

  out += "\n[fast]\n" +
         line("s_c_m2 = " + plain(stiff_beam_area_m2(body)), "beams thick enough to move less than the contact") +
         "# Its other lengths follow the body's size where they are not given; touchstone plan shows them.\n"
         "\n[compare]\n" +
         line(std::string("instants = ") + (scene.slide_m != 0.0 ? "25" : "13"),
              "recorded by both models, a tenth of the depth apart");
  return out;
}

}  // namespace touchstone::scene
