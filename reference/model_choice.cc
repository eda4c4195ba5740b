#include "reference/model_choice.h"

#include "reference/inclusions.h"
#include "reference/round_mesh.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace touchstone::reference {
namespace {

using scene::BodyShape;
using scene::Scene;
using scene::Vec3;

/// One contact of the track that the mesh should resolve.
struct ExpectedContact {
  Vec3 center_m, normal;  // on the rest surface
  double radius_m;
};

double deepest_m(const Scene& scene) {
  const auto body = scene::body_shape(scene.body);
  double depth_m = 0.0;
  for (const double time_s : scene::instants_s(scene)) {
    depth_m = std::max(depth_m, scene::rest_depth_m(*body, scene.tool, scene::pose_at(scene.track, time_s)));
  }
  return depth_m;
}

std::vector<ExpectedContact> expected_contacts(const Scene& scene) {
  constexpr double shallowest_share = 0.0999;  // of the largest depth
  const auto body = scene::body_shape(scene.body);
  const double largest_m = deepest_m(scene);
  std::vector<ExpectedContact> contacts;
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    const double depth_m = scene::rest_depth_m(*body, scene.tool, pose);
    if (depth_m <= 0.0 || depth_m < shallowest_share * largest_m) continue;
    const scene::SurfaceQuery nearest = body->query(pose.position_m);
    contacts.push_back({nearest.point_m, nearest.normal, expected_contact_radius_m(scene, depth_m)});
  }
  return contacts;
}

/// 2^(-level / 3): how the far field shrinks.
double far_share(int level) { return std::exp2(-level / 3.0); }

/// Sizes of every contact relative to the deepest one's.
double size_share(const Scene& scene, double radius_m) {
  return radius_m / expected_contact_radius_m(scene, deepest_m(scene));
}

/// Mean principal curvature of the body's top [1/m].
double top_curvature_per_m(const scene::Body& body) {
  switch (body.shape) {
    case BodyShape::box:
      return 0.0;
    case BodyShape::sphere:
      return 1.0 / body.radius_m;
    case BodyShape::ellipsoid: {
      const Vec3 a_m = body.semi_axes_m;
      return a_m.z() / (a_m.x() * a_m.y());
    }
    case BodyShape::revolution: {
      const scene::Revolution shape(body.profile);
      return shape.meridian(shape.piece_count() - 1, 1.0).curvature_along_per_m;
    }
  }
  return 0.0;
}

template <int dim>
Grading<dim> level_grading(const Scene& scene, int level) {
  constexpr double coarsest_cells = dim == 2 ? 8.0 : 2.0;  // to the radius of an inclusion
  Grading<dim> grading;
  for (const ExpectedContact& contact : expected_contacts(scene)) {
    FineDisc<dim> disc;
    if constexpr (dim == 3) {
      disc = {contact.center_m, contact.normal, contact.radius_m, 0.0};
    } else {
      disc = {{0.0, contact.center_m.z()}, {0.0, 1.0}, contact.radius_m, 0.0};
    }
    disc.size_m = element_size_m(scene, level) * size_share(scene, contact.radius_m);
    grading.discs.push_back(disc);
  }
  refine_at_inclusions(scene.body, coarsest_cells * std::exp2(level), grading);
  return grading;
}

Mesh<3> box_mesh(const Scene& scene, const ModelChoice& choice, int level) {
  const Vec3 size_m = scene.body.size_m;
  BlockSpec spec;
  spec.lower_m = {choice.mirror_x ? 0.0 : -0.5 * size_m.x(), choice.mirror_y ? 0.0 : -0.5 * size_m.y(), 0.0};
  spec.upper_m = {0.5 * size_m.x(), 0.5 * size_m.y(), size_m.z()};
  spec.symmetric_x = choice.mirror_x;
  spec.symmetric_y = choice.mirror_y;
  spec.grading = level_grading<3>(scene, level);
  spec.grading.growth = 0.9 * far_share(level);
  spec.grading.largest_m = 0.25 * size_m.maxCoeff() * far_share(level);
  return block_mesh(spec);
}

template <int dim>
Mesh<dim> round_level(const Scene& scene, const ModelChoice& choice, int level) {
  RoundSpec spec = round_spec(scene.body);
  spec.symmetric_x = choice.mirror_x;
  spec.symmetric_y = choice.mirror_y;
  const scene::Bounds bounds = scene::body_shape(scene.body)->bounds();
  const double half_m = 0.5 * (bounds.upper_m - bounds.lower_m).maxCoeff();
  Grading<dim> grading = level_grading<dim>(scene, level);
  grading.growth = (dim == 2 ? 0.5 : 0.9) * far_share(level);
  grading.largest_m = (dim == 2 ? 0.25 : 0.5) * half_m * far_share(level);
  // Around the edge of the support; on an ellipsoid its distance is taken across the longer axis.
  const Eigen::Vector2d edge_m = support_edge_m(spec);
  const Eigen::Vector2d stretch = spec.stretch;
  grading.sets.push_back({[edge_m, stretch](const Eigen::Matrix<double, dim, 1>& x_m) {
                            double r_m = x_m[0] / stretch.x();
                            if constexpr (dim == 3) r_m = x_m.template head<2>().cwiseQuotient(stretch).norm();
                            return std::hypot((r_m - edge_m.x()) * stretch.maxCoeff(), x_m[dim - 1] - edge_m.y());
                          },
                          half_m / (dim == 2 ? 32.0 : 8.0) / std::exp2(level)});
  return round_mesh(spec, grading);
}

}  // namespace

std::string ModelChoice::name(scene::Kinematics kinematics) const {
  std::string text;
  if (dim == 2) {
    text = "axisymmetric";
  } else {
    text = mirror_x && mirror_y ? "quarter 3D" : (mirror_x || mirror_y ? "half 3D" : "full 3D");
  }
  return text + " u-p " + (kinematics == scene::Kinematics::finite ? "finite strain" : "small strain");
}

ModelChoice choose_model(const Scene& scene) {
  const double same_m = 1e-6 * scene.tool.radius_m;
  const auto on_plane = [&](int direction) {
    return std::all_of(scene.track.begin(), scene.track.end(), [&](const scene::Waypoint& waypoint) {
      return std::abs(waypoint.pose.position_m[direction]) <= same_m;
    });
  };
  ModelChoice choice;
  choice.mirror_x = on_plane(0) && mirrored(scene.body.inclusions, 0);
  choice.mirror_y = on_plane(1) && mirrored(scene.body.inclusions, 1);
  if (on_plane(0) && on_plane(1) && revolved(scene.body)) choice.dim = 2;
  return choice;
}

std::vector<scene::Fault> unsupported_parts(const Scene& scene) {
  std::vector<scene::Fault> faults;
  const auto add = [&](const std::string& message) { faults.push_back({"", 0, 0, message}); };
  if (scene.tool.shape != scene::ToolShape::sphere) add("tool.shape: the reference knows sphere tools only");
  if (scene.tool.mass_center_m && *scene.tool.mass_center_m != Vec3::Zero())
    add("tool.mass_center_m: the reference takes the centre of the sphere");
  if (scene.contact.friction) add("contact.friction: the reference solves frictionless contact only");
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
    if (scene::rest_depth_m(*body, scene.tool, pose) <= 0.0) continue;
    std::ostringstream where;
    where << "track, t = " << time_s << " s: ";
    if (body->signed_distance_m(pose.position_m) <= 0.0) {
      add(where.str() + "the tool's centre is inside the body's rest shape; press less deep");
    } else if (pose.position_m.z() < body->bounds().lower_m.z() + scene.tool.radius_m) {
      add(where.str() + "the tool reaches below the support; keep it a radius above z = 0");
    } else {
      continue;
    }
    break;
  }
  if (scene.reference.levels < 1) add("reference.levels: at least 1, and 3 for an uncertainty");
  return faults;
}

double expected_contact_radius_m(const Scene& scene, double depth_m) {
  const double curvature_per_m = 1.0 / scene.tool.radius_m + top_curvature_per_m(scene.body);
  return std::min(std::sqrt(depth_m / curvature_per_m), scene.tool.radius_m);
}

double element_size_m(const Scene& scene, int level) {
  const double cells_per_radius = choose_model(scene).dim == 3 ? 1.5 : 4.0;
  const double coarsest_m =
      scene.reference.element_size_m.value_or(expected_contact_radius_m(scene, deepest_m(scene)) / cells_per_radius);
  return coarsest_m / std::exp2(level);
}

template <int dim>
Mesh<dim> level_mesh(const Scene& scene, const ModelChoice& choice, int level) {
  Mesh<dim> mesh;
  if constexpr (dim == 3) {
    mesh = scene.body.shape == BodyShape::box ? box_mesh(scene, choice, level) : round_level<dim>(scene, choice, level);
  } else {
    mesh = round_level<dim>(scene, choice, level);
  }
  embed_inclusions(scene.body, mesh);
  return mesh;
}

template Mesh<2> level_mesh(const Scene&, const ModelChoice&, int);
template Mesh<3> level_mesh(const Scene&, const ModelChoice&, int);

}  // namespace touchstone::reference
