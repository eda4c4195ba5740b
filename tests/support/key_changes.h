// Every key of the table with a second valid value, on scenes in which it applies: for tests of what a key changes.
#pragma once

#include "scene/input/fields.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchstone::test {

/// Two scenes that differ in one key's value alone; a choice of shape or law implies its own keys.
struct KeyChange {
  std::string key;  ///< as in the scene reference: "body.inclusion[].center_m"
  scene::Side side;
  std::shared_ptr<const scene::Scene> before;
  scene::Scene after;
};

/// A change of the text, for keys whose second value cannot be derived from the first.
struct TextChange {
  std::string key, from, to;
};

inline const std::string first_scene = R"(title = "A ball"
[body]
shape = "box"
size_m = [0.06, 0.06, 0.06]
[body.material]
youngs_modulus_pa = 3.0e6
poissons_ratio = 0.45
[[body.inclusion]]
shape = "sphere"
radius_m = 0.005
center_m = [0.012, 0.002, 0.02]
material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.4 }
[[body.inclusion]]
shape = "box"
size_m = [0.004, 0.005, 0.006]
center_m = [-0.012, 0.002, 0.02]
material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.4 }
[[body.inclusion]]
shape = "ellipsoid"
semi_axes_m = [0.004, 0.005, 0.006]
center_m = [0.012, 0.002, 0.04]
material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.4 }
[[body.inclusion]]
shape = "revolution"
profile_rz_m = [[0.0, -0.004], [0.005, 0.0], [0.0, 0.004]]
profile_arc_radius_m = [0.02, 0.03]
center_m = [-0.012, 0.002, 0.04]
material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.4 }
[[body.inclusion]]
shape = "cylinder"
radius_m = 0.003
length_m = 0.006
center_m = [-0.013, -0.015, 0.03]
material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.4 }
[tool]
shape = "sphere"
radius_m = 0.01
mass_center_m = [0.0, 0.001, 0.001]
[contact]
k1_n_per_m = 4000.0
k3_n_per_m3 = 3.0e8
r_th_m = 0.004
[contact.friction]
K = 0.5
beta = 0.75
mu_D = 0.3
[fast]
triangles = 200
body_falloff_per_m = 100.0
tool_samples = 400
rate_hz = 200.0
[reference]
levels = 3
element_size_m = 0.002
adaptive_share = 0.8
[compare]
instants = 5
[[probe]]
name = "below"
position_m = [0.001, 0.0, 0.02]
[[track]]
time_s = 0.0
position_m = [0.0, 0.0, 0.074]
[[track]]
time_s = 0.05
position_m = [0.004, 0.0, 0.067]
orientation_wxyz = [1.0, 0.0, 0.0, 0.0]
)";

/// The text with one part replaced. @throws std::logic_error where it is not there
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no \"" + from + "\" in the scene");
  return text.replace(at, from.size(), to);
}

/// Scenes that together use every key.
inline std::vector<std::string> scenes_of_all_keys() {
  const std::size_t inclusions = first_scene.find("[[body.inclusion]]"), tool = first_scene.find("[tool]");
  std::string plain = replaced(first_scene, first_scene.substr(inclusions, tool - inclusions), "");
  plain = replaced(plain, "body_falloff_per_m = 100.0\n", "");
  const std::string box = "shape = \"box\"\nsize_m = [0.06, 0.06, 0.06]\n";
  const std::string ball = "shape = \"sphere\"\nradius_m = 0.01\nmass_center_m = [0.0, 0.001, 0.001]\n";
  const std::string last = "position_m = [0.004, 0.0, 0.067]\n";
  std::string round = replaced(plain, box,
                               "shape = \"revolution\"\nprofile_rz_m = [[0.0, 0.0], [0.03, 0.0], [0.03, 0.05], "
                               "[0.0, 0.06]]\nprofile_arc_radius_m = [0.0, 0.0, 0.2]\n");
  round = replaced(round, ball, "shape = \"cylinder\"\nradius_m = 0.004\nlength_m = 0.02\nedge_radius_m = 0.001\n");
  round = replaced(round, last, "position_m = [0.001, 0.0, 0.08]\ndepth_m = 0.002\ndirection = [0.0, 0.0, -1.0]\n");
  round = replaced(round, "k1_n_per_m = 4000.0\n", "law = \"area_aware\"\nk1_per_radius_n_per_m2 = 8.0e6\n");
  round = replaced(round, "triangles", "formulation = \"published\"\ntriangles");
  std::string capsule =
      replaced(plain, box, "shape = \"ellipsoid\"\nsemi_axes_m = [0.04, 0.035, 0.03]\nsupport_height_m = 0.005\n");
  capsule = replaced(capsule, ball, "shape = \"capsule\"\nradius_m = 0.004\nlength_m = 0.01\n");
  std::string block = replaced(plain, box, "shape = \"sphere\"\nradius_m = 0.03\nsupport_height_m = 0.005\n");
  block = replaced(block, ball, "shape = \"box\"\nsize_m = [0.01, 0.011, 0.012]\n");
  const std::string cylinder = replaced(plain, box, "shape = \"cylinder\"\nradius_m = 0.03\nlength_m = 0.06\n");
  std::string mesh = replaced(plain, ball, "shape = \"mesh\"\nfile = \"compass.obj\"\nunit = \"mm\"\n");
  mesh = replaced(mesh, "[0.0, 0.0, 0.074]", "[0.0, 0.0, 2.0]");
  mesh = replaced(mesh, last, "position_m = [0.0, 0.0, 0.0]\n");
  return {first_scene, round, capsule, block, cylinder, mesh};
}

inline const std::vector<TextChange>& text_changes() {
  static const std::vector<TextChange> changes = {
      {"body.shape", "shape = \"box\"\nsize_m = [0.06, 0.06, 0.06]\n",
       "shape = \"ellipsoid\"\nsemi_axes_m = [0.04, 0.035, 0.03]\nsupport_height_m = 0.005\n"},
      {"body.inclusion[].shape", "shape = \"sphere\"\nradius_m = 0.005\n",
       "shape = \"box\"\nsize_m = [0.005, 0.005, 0.005]\n"},
      {"tool.shape", "shape = \"sphere\"\nradius_m = 0.01\n",
       "shape = \"capsule\"\nradius_m = 0.009\nlength_m = 0.002\n"},
      {"tool.file", "compass.obj", "mallet.stl"},
      {"contact.law", "k1_n_per_m = 4000.0\n", "law = \"area_aware\"\nk1_per_radius_n_per_m2 = 8.0e6\n"},
      {"body.profile_rz_m", "[0.0, 0.06]]", "[0.0, 0.061]]"},
      {"fast.formulation", "[fast]\ntriangles", "[fast]\nformulation = \"published\"\ntriangles"},
      {"track[].position_m", "[0.004, 0.0, 0.067]", "[0.004, 0.0, 0.0671]"},
      {"track[].time_s", "time_s = 0.05", "time_s = 0.06"},
      {"track[].depth_m", "depth_m = 0.002", "depth_m = 0.0021"},
      {"track[].direction", "[0.0, 0.0, -1.0]", "[0.1, 0.0, -1.0]"},
      {"track[].orientation_wxyz", "[1.0, 0.0, 0.0, 0.0]", "[0.9, 0.1, 0.0, 0.0]"},
  };
  return changes;
}

/// The object with another value of the key. @throws std::logic_error where none can be derived
template <class T>
T with_another_value(const scene::Field<T>& field, T object) {
  struct Visitor {
    T& o;
    std::string_view key;
    bool operator()(double& (*at)(T&)) const { return (at(o) *= 1.01) != 0.0; }
    bool operator()(int& (*at)(T&)) const { return ++at(o) > 0; }
    bool operator()(std::string& (*at)(T&)) const { return !(at(o) += " and more").empty(); }
    bool operator()(std::optional<double>& (*at)(T&)) const { return at(o) && (*at(o) *= 1.01) != 0.0; }
    bool operator()(std::optional<int>& (*at)(T&)) const { return at(o) && ++*at(o) > 0; }
    bool operator()(scene::Vec3& (*at)(T&)) const { return (at(o) *= 1.01).norm() > 0.0; }
    bool operator()(std::optional<scene::Vec3>& (*at)(T&)) const { return at(o) && (*at(o) *= 1.01).norm() > 0.0; }
    bool operator()(std::vector<double>& (*at)(T&)) const { return !at(o).empty() && (at(o).back() *= 1.01) != 0.0; }
    bool operator()(std::vector<Eigen::Vector2d>& (*at)(T&)) const {
      for (Eigen::Vector2d& pair : at(o)) pair *= 1.01;
      return !at(o).empty();
    }
    bool operator()(scene::OpenPosition& (*)(T&)) const { return false; }
    bool operator()(Eigen::Quaterniond& (*)(T&)) const { return false; }
    bool operator()(const scene::Choice<T>& access) const {
      access.set(o, (access.get(o) + 1) % static_cast<int>(access.names.size()));
      return access.names.size() > 1;
    }
  };
  if (!std::visit(Visitor{object, field.key}, field.access))
    throw std::logic_error("no other value of " + std::string(field.key) + "; give one in text_changes()");
  return object;
}

/// Every key of the tables but those of one possible value, each at least once.
/// @throws scene::InputError, std::logic_error where a scene is invalid or a key has no second value
inline std::vector<KeyChange> every_key_changed() {
  std::vector<KeyChange> changes;
  const std::filesystem::path file = source_folder() + "/meshes/tools/scene.toml";
  for (const std::string& text : scenes_of_all_keys()) {
    const auto before = std::make_shared<const scene::Scene>(scene::parse_scene(text, file));
    const auto change = [&](const auto& field, const auto& object, const std::string& above, const std::string& path) {
      const std::string key = above + std::string(field.key);
      bool by_text = false;
      for (const TextChange& one : text_changes()) {
        if (one.key != key) continue;
        by_text = true;
        if (text.find(one.from) == std::string::npos) continue;
        changes.push_back({key, field.side, before, scene::parse_scene(replaced(text, one.from, one.to), file)});
      }
      if (by_text || !scene::applies(field, object) || key == "body.support") return;
      // An absent value cannot be changed; another of the scenes has one.
      if (scene::value_text(field, object).empty() || scene::value_text(field, object) == "[]") return;
      const std::string value = scene::value_text(field, with_another_value(field, object));
      changes.push_back(
          {key, field.side, before, scene::parse_scene(text, file, {path + std::string(field.key) + "=" + value})});
    };
    for (const auto& field : scene::scene_fields()) change(field, *before, "", "");
    for (std::size_t i = 0; i < before->body.inclusions.size(); ++i) {
      for (const auto& field : scene::inclusion_fields())
        change(field, before->body.inclusions[i], "body.inclusion[].", "body.inclusion[" + std::to_string(i) + "].");
    }
    for (const auto& field : scene::probe_fields()) change(field, before->probes[0], "probe[].", "probe[0].");
    for (const auto& field : scene::track_fields()) change(field, scene::TrackRow{}, "track[].", "track[1].");
  }
  return changes;
}

}  // namespace touchstone::test
