#include "reference/run/model_choice.h"

#include "reference/mesh/inclusions.h"
#include "reference/mesh/round_mesh.h"
#include "reference/tool/tool_distance.h"
#include "reference/tool/tool_symmetry.h"
#include "scene/model/solid_kinds.h"
#include "scene/shape/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

namespace touchstone::reference {
namespace {

using scene::BodyShape;
using scene::Scene;
using scene::Vec3;

/// The deepest contact of all instants decides which of the others matter.
void expect_contacts(const Scene& scene, ModelChoice& choice) {
  constexpr double shallowest_share = 0.0999;  // of the largest depth
  const auto body = scene::body_shape(scene.body);
  std::optional<ToolPoints> points;
  if (scene.tool.shape != scene::ToolShape::sphere) points = tool_points(scene.tool, *choice.tool);
  double largest_m = 0.0;
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    std::vector<ContactPatch> now;
    if (points) {
      now = contact_patches(*body, *points, pose, scene.contact.r_th_m);
    } else if (const double depth_m = scene::rest_depth_m(*body, scene.tool, pose); depth_m > 0.0) {
      const Vec3 center_m = pose.position_m - pose.orientation * scene.tool.mass_center_m.value_or(Vec3::Zero());
      const scene::SurfaceQuery nearest = body->query(center_m);
      const double radius_m = expected_contact_radius_m(scene, depth_m);
      now.push_back({nearest.point_m, nearest.normal, depth_m, radius_m, {{nearest.point_m, radius_m}}, {}});
    }
    for (ContactPatch& patch : now) {
      if (patch.depth_m > largest_m) {
        largest_m = patch.depth_m;
        choice.half_width_m = patch.half_width_m;
      }
      choice.contacts.push_back(std::move(patch));
    }
  }
  std::erase_if(choice.contacts,
                [&](const ContactPatch& patch) { return patch.depth_m < shallowest_share * largest_m; });
}

/// Small cells where the contacts, the tight bends of the tool and the inclusions' surfaces are, on the mesh's side of
/// its mirror planes.
template <int dim>
Grading<dim> level_grading(const Scene& scene, const ModelChoice& choice, int level, const MeshChange& change) {
  // To the radius of an inclusion.
  constexpr double coarsest_cells = dim == 2 ? 8.0 : 1.0, coarsest_following_cells = dim == 2 ? 4.0 : 1.0;
  const double finer = refinement(level);
  Grading<dim> grading;
  grading.halves_the_block = true;
  const double base_m = element_size_m(scene, choice, level);
  const auto add = [&](const Vec3& center_m, const Vec3& normal, double radius_m, double size_m) {
    if constexpr (dim == 3) {
      const double beyond_m = radius_m + size_m;
      if ((choice.mirror_x && center_m.x() < -beyond_m) || (choice.mirror_y && center_m.y() < -beyond_m)) return;
      grading.discs.push_back({center_m, normal, radius_m, size_m});
    } else {
      grading.discs.push_back({{center_m.head<2>().norm(), center_m.z()}, {0.0, 1.0}, radius_m, size_m});
    }
  };
  // One disc for all the places of tight bend in one cube of a few cells.
  std::set<std::array<long, 3>> taken;
  for (const ContactPatch& patch : choice.contacts) {
    const double size_m = base_m * patch.half_width_m / choice.half_width_m;
    for (const ContactPatch::Disc& disc : patch.discs) add(disc.center_m, patch.normal, disc.radius_m, size_m);
    for (const ContactPatch::Rim& rim : patch.rims) {
      const double rim_m = std::max(rim_share * rim.bend_radius_m / finer, base_m / 16.0);
      if (rim_m >= size_m) continue;
      Vec3 place_m = rim.place_m;
      if (choice.dim == 2) place_m = {place_m.head<2>().norm(), 0.0, place_m.z()};
      const Vec3 cube = place_m / (2.0 * rim_m);
      if (!taken.insert({std::lround(cube.x()), std::lround(cube.y()), std::lround(cube.z())}).second) continue;
      add(place_m, patch.normal, 0.0, rim_m);
    }
  }
  if (const auto& coarse = choice.following_grid<dim>()) {
    const auto more = static_cast<int>(std::lround(std::log2(finer / change.inclusions)));
    refine_at_inclusions<dim>(*coarse, coarsest_following_cells, more, grading);
  } else {
    refine_at_inclusions(scene.body, coarsest_cells * finer / change.inclusions, grading);
  }
  return grading;
}

/// Largest cell edge over the distance from the contact. Measured in three dimensions: 1.3 against 0.9 halves the
/// unknowns and adds 0.1 % of force; the far field's sensitivity holds it.
template <int dim>
constexpr double growth = dim == 2 ? 0.5 : 1.3;

BlockSpec block_spec(const Scene& scene, const ModelChoice& choice) {
  const Vec3 size_m = scene.body.size_m;
  BlockSpec spec;
  spec.lower_m = {choice.mirror_x ? 0.0 : -0.5 * size_m.x(), choice.mirror_y ? 0.0 : -0.5 * size_m.y(), 0.0};
  spec.upper_m = {0.5 * size_m.x(), 0.5 * size_m.y(), size_m.z()};
  spec.symmetric_x = choice.mirror_x;
  spec.symmetric_y = choice.mirror_y;
  return spec;
}

Discretisation<3> box_mesh(const Scene& scene, const ModelChoice& choice, int level, const MeshChange& change) {
  BlockSpec spec = block_spec(scene, choice);
  const double far = change.far_field * far_share(level);
  spec.grading = level_grading<3>(scene, choice, level, change);
  spec.grading.growth = growth<3> * far;
  spec.grading.largest_m = 0.125 * scene.body.size_m.maxCoeff() * far;
  return choice.following_grid<3>() ? following_mesh<3>(choice.following_grid<3>(), spec.grading) : block_mesh(spec);
}

RoundSpec mirrored_round_spec(const Scene& scene, const ModelChoice& choice) {
  RoundSpec spec = round_spec(scene.body);
  spec.symmetric_x = choice.mirror_x;
  spec.symmetric_y = choice.mirror_y;
  return spec;
}

template <int dim>
Discretisation<dim> round_level(const Scene& scene, const ModelChoice& choice, int level, const MeshChange& change) {
  const RoundSpec spec = mirrored_round_spec(scene, choice);
  const scene::Bounds bounds = scene::body_shape(scene.body)->bounds();
  const double half_m = 0.5 * (bounds.upper_m - bounds.lower_m).maxCoeff();
  const double far = change.far_field * far_share(level);
  Grading<dim> grading = level_grading<dim>(scene, choice, level, change);
  grading.growth = growth<dim> * far;
  grading.largest_m = 0.25 * half_m * far;
  // Around the edge of the support; on an ellipsoid its distance is taken across the longer axis.
  const Eigen::Vector2d edge_m = support_edge_m(spec);
  const Eigen::Vector2d stretch = spec.stretch;
  grading.sets.push_back({[edge_m, stretch](const Eigen::Matrix<double, dim, 1>& x_m) {
                            double r_m = x_m[0] / stretch.x();
                            if constexpr (dim == 3) r_m = x_m.template head<2>().cwiseQuotient(stretch).norm();
                            return std::hypot((r_m - edge_m.x()) * stretch.maxCoeff(), x_m[dim - 1] - edge_m.y());
                          },
                          half_m / (dim == 2 ? 32.0 : 8.0) / refinement(level)});
  const auto& coarse = choice.following_grid<dim>();
  return coarse ? following_mesh<dim>(coarse, grading) : round_mesh(spec, grading);
}

/// Times at which a symmetry is looked at: those with a pose of their own, and one in between, not in the middle.
std::vector<double> symmetry_times_s(const Scene& scene) {
  std::vector<double> times_s = scene::instants_s(scene);
  for (const scene::Waypoint& waypoint : scene.track) times_s.push_back(waypoint.time_s);
  std::sort(times_s.begin(), times_s.end());
  const std::size_t count = times_s.size();
  for (std::size_t i = 1; i < count; ++i) times_s.push_back(times_s[i - 1] + 0.382 * (times_s[i] - times_s[i - 1]));
  return times_s;
}

/// The lowest point of a placed tool.
double lowest_m(const scene::Tool& tool, const scene::Pose& pose) {
  if (tool.shape == scene::ToolShape::sphere) {
    return (pose.position_m - pose.orientation * tool.mass_center_m.value_or(Vec3::Zero())).z() - tool.radius_m;
  }
  const Eigen::Matrix3Xd points_m = scene::tool_surface(tool, 2000).points_m;
  return (pose.orientation.toRotationMatrix() * points_m).row(2).minCoeff() + pose.position_m.z();
}

}  // namespace

std::string ModelChoice::name(scene::Kinematics kinematics) const {
  std::string text;
  if (dim == 2) {
    text = "axisymmetric";
  } else {
    text = mirror_x && mirror_y ? "quarter 3D" : (mirror_x || mirror_y ? "half 3D" : "full 3D");
  }
  text += std::string(" u-p ") + (kinematics == scene::Kinematics::finite ? "finite strain" : "small strain");
  return text + (follows() ? ", cells along inclusions" : "");
}

ModelChoice choose_model(const Scene& scene) {
  const auto always = [&](const scene::Mat3& map) {
    const std::vector<double> times_s = symmetry_times_s(scene);
    return std::all_of(times_s.begin(), times_s.end(), [&](double time_s) {
      const scene::Pose pose = scene::pose_at(scene.track, time_s);
      return maps_to_itself(scene.tool, pose, map) &&
             (!scene.contact.friction || moves_alike(scene::pose_at(scene.track, times_s.front()), pose, map));
    });
  };
  // With friction a tool that turns about its own axis twists the body: no mirror image of itself.
  const Vec3 across_x(-1.0, 1.0, 1.0), across_y(1.0, -1.0, 1.0);
  ModelChoice choice;
  choice.mirror_x = mirrored(scene.body.inclusions, 0) && always(across_x.asDiagonal());
  choice.mirror_y = mirrored(scene.body.inclusions, 1) && always(across_y.asDiagonal());
  // A turn by one radian is no symmetry but of a body of revolution.
  if (revolved(scene.body) && always(Eigen::AngleAxisd(1.0, Vec3::UnitZ()).toRotationMatrix()) &&
      (!scene.contact.friction || choice.mirror_x)) {
    choice.dim = 2;
  }
  choice.tool = tool_distance(scene.tool);
  expect_contacts(scene, choice);
  follow_inclusions(scene, choice);
  return choice;
}

void follow_inclusions(const Scene& scene, ModelChoice& choice) {
  choice.following = {};
  choice.why_cut.clear();
  if (scene.body.inclusions.empty()) return;
  auto& [in_plane, in_space] = choice.following;
  if (scene.body.shape == BodyShape::box) {
    in_space = following_grid<3>(block_cells(block_spec(scene, choice)), scene.body, choice.why_cut);
  } else if (!round_fault(round_spec(scene.body)).empty()) {
    choice.why_cut = "the body has no mesh";
  } else if (choice.dim == 2) {
    in_plane = following_grid<2>(round_cells<2>(mirrored_round_spec(scene, choice)), scene.body, choice.why_cut);
  } else {
    in_space = following_grid<3>(round_cells<3>(mirrored_round_spec(scene, choice)), scene.body, choice.why_cut);
  }
}

std::vector<scene::Fault> unsupported_parts(const Scene& scene) {
  std::vector<scene::Fault> faults;
  const auto add = [&](const std::string& message) { faults.push_back({"", 0, 0, message}); };
  if (scene.tool.shape == scene::ToolShape::cylinder &&
      scene.tool.edge_radius_m < smallest_fillet_share * scene.tool.radius_m) {
    add(fmt::format(
        "tool.edge_radius_m: a sharp rim has unbounded pressure and the reference stops converging; expected at "
        "least a quarter of the radius, {:g} m, found {:g} m",
        smallest_fillet_share * scene.tool.radius_m, scene.tool.edge_radius_m));
  }
  if (!faults.empty()) return faults;
  if (scene.body.shape != BodyShape::box) {
    if (const std::string fault = round_fault(round_spec(scene.body)); !fault.empty()) {
      const bool profile = scene.body.shape == BodyShape::revolution;
      add((profile ? "body.profile_rz_m: " : "body.support_height_m: ") + fault);
    }
  }
  const auto body = scene::body_shape(scene.body);
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    const double depth_m = scene::rest_depth_m(*body, scene.tool, pose);
    if (depth_m <= 0.0) continue;
    const bool round = scene.tool.shape == scene::ToolShape::sphere || scene.tool.shape == scene::ToolShape::capsule;
    const std::string where = fmt::format("track, t = {:g} s: ", time_s);
    if (round && depth_m >= scene.tool.radius_m) {
      add(where + fmt::format("the tool's centre is inside the body's rest shape; expected a depth below the radius, "
                              "{:g} m, found {:.4g} m",
                              scene.tool.radius_m, depth_m));
    } else if (const double z_m = lowest_m(scene.tool, pose); z_m < body->bounds().lower_m.z()) {
      add(where +
          fmt::format("the tool reaches below the support; expected its lowest point above z = 0 m, found it at "
                      "{:.4g} m",
                      z_m));
    } else {
      continue;
    }
    break;
  }
  if (scene.reference.levels.value_or(1) < 1) add("reference.levels: at least 1, and 3 for an uncertainty");
  return faults;
}

double expected_contact_radius_m(const Scene& scene, double depth_m) {
  const double curvature_per_m = 1.0 / scene.tool.radius_m + scene::top_curvature_per_m(scene.body);
  return std::min(std::sqrt(depth_m / curvature_per_m), scene.tool.radius_m);
}

double element_size_m(const Scene& scene, const ModelChoice& choice, int level) {
  const double cells_per_radius = choice.dim == 3 ? 1.5 : 4.0;
  return scene.reference.element_size_m.value_or(choice.half_width_m / cells_per_radius) / refinement(level);
}

double refinement(int level) { return std::exp2(level); }

double far_share(int level) { return std::exp2(-(level / 4)); }

template <int dim>
Discretisation<dim> level_mesh(const Scene& scene, const ModelChoice& choice, int level, const MeshChange& change) {
  Discretisation<dim> mesh;
  if constexpr (dim == 3) {
    mesh = scene.body.shape == BodyShape::box ? box_mesh(scene, choice, level, change)
                                              : round_level<dim>(scene, choice, level, change);
  } else {
    mesh = round_level<dim>(scene, choice, level, change);
  }
  embed_inclusions(scene.body, mesh);
  return mesh;
}

template Discretisation<2> level_mesh(const Scene&, const ModelChoice&, int, const MeshChange&);
template Discretisation<3> level_mesh(const Scene&, const ModelChoice&, int, const MeshChange&);

}  // namespace touchstone::reference
