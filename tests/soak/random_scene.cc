#include "soak/random_scene.h"

#include "scene/base/error.h"
#include "scene/mesh/mesh_file.h"
#include "scene/model/rules.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace touchstone::soak {
namespace {

using scene::BodyShape;
using scene::Formulation;
using scene::ToolShape;
using scene::Vec3;

scene::Profile random_profile(double size_m, Random& random) {
  const double radius_m = size_m * random.decades(0.2, 1.0), height_m = size_m * random.decades(0.3, 2.0);
  switch (random.below(6)) {
    case 0:
      return scene::cylinder_profile(radius_m, height_m, 0.0);
    case 1:
      return scene::cylinder_profile(radius_m, height_m,
                                     random.uniform(0.05, 0.9) * std::min(radius_m, 0.5 * height_m));
    case 2:
      return scene::capsule_profile(radius_m, height_m);
    case 3:  // a cone
      return {{{0.0, 0.0}, {radius_m, 0.0}, {0.0, height_m}}, {}};
    case 4:  // a truncated cone
      return {{{0.0, 0.0}, {radius_m, 0.0}, {random.uniform(0.1, 0.9) * radius_m, height_m}, {0.0, height_m}}, {}};
    default:  // two cones
      return {{{0.0, 0.0}, {radius_m, random.uniform(0.3, 0.7) * height_m}, {0.0, height_m}}, {}};
  }
}

scene::Solid random_solid(BodyShape shape, double size_m, Random& random) {
  scene::Solid solid;
  solid.shape = shape;
  switch (shape) {
    case BodyShape::box:
      for (double& edge_m : solid.size_m) edge_m = size_m * random.decades(0.4, 2.0);
      break;
    case BodyShape::sphere:
      solid.radius_m = 0.5 * size_m;
      break;
    case BodyShape::ellipsoid:
      for (double& axis_m : solid.semi_axes_m) axis_m = 0.5 * size_m * random.decades(0.4, 2.0);
      break;
    case BodyShape::revolution:
      solid.profile = random_profile(size_m, random);
      break;
  }
  return solid;
}

Vec3 extent_m(const scene::Body& body) {
  const scene::Bounds bounds = scene::body_shape(body)->bounds();
  return bounds.upper_m - bounds.lower_m;
}

scene::Body random_body(BodyShape shape, Random& random) {
  scene::Body body;
  static_cast<scene::Solid&>(body) = random_solid(shape, random.decades(1e-3, 1.0), random);
  body.material = {random.decades(1e2, 1e11), random.chance(0.3) ? 0.5 : random.uniform(0.0, 0.5)};
  if (!body.flat_bottom()) body.support_height_m = random.uniform(0.01, 0.45) * extent_m(body).z();
  return body;
}

/// Up to four solids inside, as far as they fit.
void add_inclusions(scene::Scene& scene, Random& random) {
  const Vec3 size_m = extent_m(scene.body);
  for (int wished = 1 + random.below(4); wished > 0; --wished) {
    scene::Inclusion inclusion;
    static_cast<scene::Solid&>(inclusion) =
        random_solid(static_cast<BodyShape>(random.below(4)), random.uniform(0.05, 0.4) * size_m.minCoeff(), random);
    inclusion.center_m = {random.uniform(-0.4, 0.4) * size_m.x(), random.uniform(-0.4, 0.4) * size_m.y(),
                          random.uniform(0.1, 0.9) * size_m.z()};
    inclusion.material = {std::clamp(scene.body.material.youngs_modulus_pa * random.decades(1e-6, 1e6), 1e-3, 9e12),
                          random.uniform(0.0, 0.5)};
    scene.body.inclusions.push_back(inclusion);
    if (!scene::broken_rules(scene).empty()) scene.body.inclusions.pop_back();
  }
}

/// A plate with square pins of unequal length below it.
scene::TriangleMesh pins(Random& random) {
  scene::TriangleMesh mesh;
  const auto add_box = [&](const Vec3& lower_m, const Vec3& upper_m) {
    const auto first = static_cast<std::int32_t>(mesh.points_m.cols());
    mesh.points_m.conservativeResize(3, first + 8);
    for (int i = 0; i < 8; ++i) {
      mesh.points_m.col(first + i) =
          Vec3((i & 1) != 0 ? upper_m.x() : lower_m.x(), (i & 2) != 0 ? upper_m.y() : lower_m.y(),
               (i & 4) != 0 ? upper_m.z() : lower_m.z());
    }
    constexpr std::array<std::array<int, 4>, 6> faces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& f : faces) {
      mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
      mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  };
  const int rows = 1 + random.below(4), columns = 2 + random.below(3);
  const double side_m = random.uniform(0.02, 0.5) / std::max(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const Vec3 middle_m((k + 0.5) / columns - 0.5, (i + 0.5) / rows - 0.5, random.uniform(0.0, 0.1));
      const Vec3 half_m(0.5 * side_m, 0.5 * side_m, 0.0);
      add_box(middle_m - half_m, Vec3(middle_m + half_m + Vec3(0.0, 0.0, 0.2)));
    }
  }
  return mesh;
}

scene::Tool random_tool(ToolShape shape, double size_m, const ToolMeshes& meshes, Random& random) {
  const auto length_m = [&](double low, double high) {
    return std::clamp(size_m * random.decades(low, high), 2e-5, 9.9);
  };
  scene::Tool tool;
  tool.shape = shape;
  tool.mass_kg = random.decades(1e-3, 1e2);
  switch (shape) {
    case ToolShape::sphere:
      tool.radius_m = length_m(0.5, 0.5);
      break;
    case ToolShape::capsule:
      tool.radius_m = length_m(0.2, 0.5);
      tool.length_m = random.chance(0.1) ? 0.0 : length_m(0.2, 2.0);
      break;
    case ToolShape::cylinder:
      tool.radius_m = length_m(0.2, 0.5);
      tool.length_m = length_m(0.1, 2.0);
      if (random.chance(0.7))
        tool.edge_radius_m = random.uniform(0.0, 1.0) * std::min(tool.radius_m, 0.5 * tool.length_m);
      break;
    case ToolShape::box:
      for (double& edge_m : tool.size_m) edge_m = length_m(0.3, 1.5);
      break;
    case ToolShape::mesh: {
      const int kind = random.below(2 * static_cast<int>(meshes.size()));
      const auto shipped = static_cast<std::size_t>(kind);
      scene::TriangleMesh mesh = shipped < meshes.size() ? meshes[shipped] : pins(random);
      mesh.points_m *= length_m(1.0, 1.0);
      tool.mesh = std::make_shared<const scene::TriangleMesh>(std::move(mesh));
      break;
    }
  }
  if (random.chance(0.3)) tool.mass_center_m = 0.3 * std::min(size_m, 9.9) * random.direction();
  return tool;
}

scene::Contact random_contact(double modulus_pa, double size_m, Random& random) {
  const auto in_range = [](double value, double most) { return std::clamp(value, -most, most); };
  scene::Contact contact;
  contact.law = random.chance(0.5) ? scene::ContactLaw::duffing : scene::ContactLaw::area_aware;
  contact.k1_n_per_m = in_range(modulus_pa * size_m * random.decades(1e-4, 10.0), 1e12);
  contact.k1_per_radius_n_per_m2 = in_range(modulus_pa * random.decades(1e-3, 10.0), 1e15);
  if (random.chance(0.7)) {
    const double sign = random.chance(0.3) ? -1.0 : 1.0;
    contact.k3_n_per_m3 = in_range(sign * contact.k1_n_per_m / (size_m * size_m) * random.decades(1e-2, 1e5), 1e18);
  }
  if (random.chance(0.5)) {
    scene::Friction friction;
    friction.K = random.decades(1e-3, 1e3);
    friction.beta = random.chance(0.3) ? 1.0 : random.uniform(2.0 / 3.0, 1.0);
    friction.mu_D = std::min(random.decades(1e-2, 3.0), friction.beta == 1.0 ? friction.K : 10.0);
    friction.stiffness_ratio = random.chance(0.5) ? 1.0 : random.decades(1e-3, 1e3);
    contact.friction = friction;
  }
  return contact;
}

void set_random_settings(scene::Scene& scene, Formulation formulation, double size_m, Random& random) {
  scene::FastSettings& fast = scene.fast;
  fast.formulation = formulation;
  fast.triangles = static_cast<int>(random.decades(12.0, 2000.0));
  fast.tool_samples = static_cast<int>(random.decades(1.0, 2000.0));
  fast.rate_hz = 1000.0;
  fast.max_regions = 1 + random.below(12);
  scene.contact.r_th_m = std::min(0.9, size_m * random.decades(1e-2, 1.0));
  fast.r_R_m = size_m * random.decades(1e-2, 2.0);
  fast.C_r_m = size_m * random.decades(1e-3, 1.0);
  // In the corrected form up to where the local factor would turn negative (errata E16).
  const double most = 1.0 / std::log((fast.r_R_m + fast.C_r_m) / fast.C_r_m);
  if (random.chance(0.8))
    fast.C_n = std::min(
        999.0, formulation == Formulation::corrected ? random.uniform(0.0, 0.999) * most : random.decades(1e-2, 10.0));
  fast.s_c_m2 = size_m * size_m * random.decades(1e-4, 1e3);
}

scene::LiveSettings random_hand(Random& random) {
  scene::LiveSettings live;
  live.force_max_n = random.decades(0.01, 40.0);
  live.force_slew_n_per_s = random.decades(1e2, 1e6);
  live.release_s = 0.1;
  live.hand_mass_kg = random.decades(0.05, 1.0);
  live.hand_damping_n_s_per_m = random.decades(1.0, 20.0);
  live.hand_stiffness_n_per_m = random.decades(100.0, 2000.0);
  return live;
}

}  // namespace

ToolMeshes tool_meshes(const std::filesystem::path& folder) {
  ToolMeshes meshes;
  for (const char* name : {"compass.obj", "mallet.stl", "stylus.stl"}) {
    std::vector<scene::Fault> faults;
    std::optional<scene::TriangleMesh> mesh = scene::read_triangle_mesh(folder / name, 1e-3, faults);
    if (!mesh) throw scene::InputError(faults);
    const scene::Bounds bounds = mesh->bounds();
    mesh->points_m.colwise() -= 0.5 * (bounds.lower_m + bounds.upper_m);
    mesh->points_m /= (bounds.upper_m - bounds.lower_m).maxCoeff();
    meshes.push_back(std::move(*mesh));
  }
  return meshes;
}

scene::Scene random_scene(int index, const ToolMeshes& meshes, Random& random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    scene::Scene scene;
    scene.body = random_body(static_cast<BodyShape>(index % 4), random);
    const double size_m = extent_m(scene.body).minCoeff();
    const double ratio = random.chance(0.5) ? random.decades(0.05, 2.0) : random.decades(1e-3, 1e3);
    scene.tool = random_tool(static_cast<ToolShape>(index / 4 % 5), ratio * size_m, meshes, random);
    scene.contact = random_contact(scene.body.material.youngs_modulus_pa, size_m, random);
    set_random_settings(scene, static_cast<Formulation>(index / 20 % 2), size_m, random);
    scene.live = random_hand(random);
    scene.compare.instants = 2;
    const scene::Pose far{Vec3(0.0, 0.0, 100.0), Eigen::Quaterniond::Identity()};
    scene.track = {{0.0, far}, {1.0, far}};
    if (!scene::broken_rules(scene).empty()) continue;
    if (random.chance(0.5)) add_inclusions(scene, random);
    return scene;
  }
  throw std::logic_error("no valid scene in 1000 attempts");
}

std::string words_for(const scene::Scene& scene) {
  constexpr std::array bodies{"box", "sphere", "ellipsoid", "revolution"};
  constexpr std::array tools{"sphere", "capsule", "cylinder", "box", "mesh"};
  std::string words = std::string(bodies[static_cast<std::size_t>(scene.body.shape)]) + " under " +
                      tools[static_cast<std::size_t>(scene.tool.shape)];
  words += scene.fast.formulation == Formulation::published ? ", published" : ", corrected";
  words += scene.contact.law == scene::ContactLaw::duffing ? ", duffing" : ", area_aware";
  if (scene.contact.friction) words += ", friction";
  if (!scene.body.inclusions.empty()) words += ", inclusions";
  if (!scene.tool.convex() && scene.fast.max_regions > 1) words += ", several regions";
  return words;
}

}  // namespace touchstone::soak
