#include "reference/model_choice.h"

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
  choice.mirror_x = on_plane(0);
  choice.mirror_y = on_plane(1);
  if (scene.body.shape == BodyShape::sphere) choice.dim = 2;
  return choice;
}

std::vector<scene::Fault> unsupported_parts(const Scene& scene) {
  std::vector<scene::Fault> faults;
  const auto add = [&](const std::string& message) { faults.push_back({"", 0, 0, message}); };
  if (scene.body.shape == BodyShape::ellipsoid || scene.body.shape == BodyShape::revolution)
    add("body.shape: the reference solves box and sphere bodies only");
  if (!scene.body.inclusions.empty()) add("body.inclusion: the reference solves bodies of one material only");
  if (scene.tool.shape != scene::ToolShape::sphere) add("tool.shape: the reference knows sphere tools only");
  if (scene.tool.mass_center_m && *scene.tool.mass_center_m != Vec3::Zero())
    add("tool.mass_center_m: the reference takes the centre of the sphere");
  if (scene.contact.friction) add("contact.friction: the reference solves frictionless contact only");
  if (!faults.empty()) return faults;
  const ModelChoice choice = choose_model(scene);
  const auto body = scene::body_shape(scene.body);
  if (scene.body.shape == BodyShape::sphere) {
    if (!choice.mirror_x || !choice.mirror_y) {
      add("track: the reference solves a sphere body only as a body of revolution; keep the tool on the z axis (x = y "
          "= 0)");
    }
    const double share = scene.body.support_height_m / scene.body.radius_m;
    if (share < BallSpec::smallest_support_share || share > BallSpec::largest_support_share) {
      std::ostringstream text;
      text << "body.support_height_m: the reference needs " << BallSpec::smallest_support_share << " to "
           << BallSpec::largest_support_share << " body radii, not " << share;
      add(text.str());
    }
  }
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
  double curvature_per_m = 1.0 / scene.tool.radius_m;
  if (scene.body.shape == BodyShape::sphere) curvature_per_m += 1.0 / scene.body.radius_m;
  return std::min(std::sqrt(depth_m / curvature_per_m), scene.tool.radius_m);
}

double element_size_m(const Scene& scene, int level) {
  const double cells_per_radius = scene.body.shape == BodyShape::box ? 1.5 : 4.0;
  const double coarsest_m =
      scene.reference.element_size_m.value_or(expected_contact_radius_m(scene, deepest_m(scene)) / cells_per_radius);
  return coarsest_m / std::exp2(level);
}

Mesh<3> box_level(const Scene& scene, const ModelChoice& choice, int level) {
  const Vec3 size_m = scene.body.size_m;
  BlockSpec spec;
  spec.lower_m = {choice.mirror_x ? 0.0 : -0.5 * size_m.x(), choice.mirror_y ? 0.0 : -0.5 * size_m.y(), 0.0};
  spec.upper_m = {0.5 * size_m.x(), 0.5 * size_m.y(), size_m.z()};
  spec.symmetric_x = choice.mirror_x;
  spec.symmetric_y = choice.mirror_y;
  spec.grading.growth = 0.9 * far_share(level);
  spec.grading.largest_m = 0.25 * size_m.maxCoeff() * far_share(level);
  for (const ExpectedContact& contact : expected_contacts(scene)) {
    spec.grading.discs.push_back({contact.center_m, contact.normal, contact.radius_m,
                                  element_size_m(scene, level) * size_share(scene, contact.radius_m)});
  }
  return block_mesh(spec);
}

Mesh<2> ball_level(const Scene& scene, int level) {
  const double R_m = scene.body.radius_m, support_m = scene.body.support_height_m;
  BallSpec spec{R_m, support_m, {}};
  spec.grading.growth = 0.5 * far_share(level);
  spec.grading.largest_m = 0.25 * R_m * far_share(level);
  for (const ExpectedContact& contact : expected_contacts(scene)) {
    spec.grading.discs.push_back({{0.0, contact.center_m.z()},
                                  {0.0, 1.0},
                                  contact.radius_m,
                                  element_size_m(scene, level) * size_share(scene, contact.radius_m)});
  }
  const double support_radius_m = std::sqrt(std::max(0.0, support_m * (2.0 * R_m - support_m)));
  spec.grading.discs.push_back({{support_radius_m, support_m}, {0.0, 1.0}, 0.0, R_m / 32.0 / std::exp2(level)});
  return ball_mesh(spec);
}

}  // namespace touchstone::reference
