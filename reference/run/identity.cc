#include "reference/run/identity.h"

#include "reference/tool/distance_grid.h"
#include "reference/tool/tool_distance.h"
#include "scene/base/hash.h"
#include "scene/model/body_text.h"

#include <iomanip>
#include <sstream>
#include <string_view>

namespace touchstone::reference {
namespace {

using scene::Scene;

/// Raised with every change of method that moves a result; results of other versions are then not found.
constexpr const char* method_version = "touchstone reference 4: Q2-P1disc u-p, primal-dual active set";

/// Raised alike, for scenes with friction alone.
constexpr const char* friction_method = "3";

/// Raised alike, for bodies with inclusions alone: whether cells follow them depends on the scene and nothing else.
constexpr const char* inclusion_method = "2: cells along balls and ellipsoids";

/// Raised alike, for meshes refined by the estimator alone.
constexpr const char* adaptive_method = "1";

std::string tool_text(const scene::Tool& tool) {
  std::ostringstream text;
  text << std::setprecision(17);
  switch (tool.shape) {
    case scene::ToolShape::sphere:
      text << "sphere " << tool.radius_m;
      break;
    case scene::ToolShape::capsule:
      text << "capsule " << tool.radius_m << ' ' << tool.length_m;
      break;
    case scene::ToolShape::cylinder:
      text << "cylinder " << tool.radius_m << ' ' << tool.length_m << ' ' << tool.edge_radius_m;
      break;
    case scene::ToolShape::box:
      text << "box " << tool.size_m.transpose() << " rounded by " << box_edge_share;
      break;
    case scene::ToolShape::mesh: {
      const scene::TriangleMesh& mesh = *tool.mesh;
      const auto bytes = [](const auto* data, auto count) {
        return std::string_view(reinterpret_cast<const char*>(data), count * sizeof *data);
      };
      text << "mesh " << scene::hash_text(bytes(mesh.points_m.data(), mesh.points_m.size())) << ' '
           << scene::hash_text(bytes(mesh.triangles.data(), mesh.triangles.size())) << " on a grid of "
           << grid_spacing_m(mesh);
      break;
    }
  }
  if (tool.mass_center_m) text << " mass centre " << tool.mass_center_m->transpose();
  return text.str();
}

}  // namespace

std::string identity_text(const Scene& scene) {
  std::ostringstream text;
  text << std::setprecision(17) << method_version << '\n' << scene::body_text(scene.body);
  text << "tool " << tool_text(scene.tool) << '\n'
       << "regions " << scene.contact.r_th_m << " apart\n"
       << "kinematics " << (scene.reference.kinematics == scene::Kinematics::finite ? "finite" : "small") << " element "
       << (scene.reference.element_size_m ? std::to_string(*scene.reference.element_size_m * 1e9) + " nm" : "automatic")
       << '\n';
  if (!scene.body.inclusions.empty()) text << "inclusions " << inclusion_method << '\n';
  if (const auto share = scene.reference.adaptive_share)
    text << "adaptive " << adaptive_method << ' ' << *share << '\n';
  if (const auto& friction = scene.contact.friction) {
    text << "friction " << friction_method << " K " << friction->K << " beta " << friction->beta << " mu_D "
         << friction->mu_D << '\n';
  }
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    text << "instant " << time_s << " tool at " << pose.position_m.transpose() << " turned "
         << pose.orientation.coeffs().transpose() << '\n';
  }
  return text.str();
}

}  // namespace touchstone::reference
