// Tools of every form in one size, for tests over all of them.
#pragma once

#include "scene/model/scene.h"
#include "support/bodies.h"
#include "support/mesh_tools.h"
#include "support/press.h"

#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace touchstone::test {

struct NamedTool {
  std::string name;
  scene::Tool tool;
  std::shared_ptr<const scene::Shape> shape;  ///< its surface; of a mesh, what it was made from
};
inline void PrintTo(const NamedTool& tool, std::ostream* out) { *out << tool.name; }

/// Tools whose smallest radius is about this.
inline std::vector<NamedTool> tools(double radius_m) {
  scene::Tool capsule, cylinder, box, mesh, fine;
  capsule.shape = scene::ToolShape::capsule;
  cylinder.shape = scene::ToolShape::cylinder;
  box.shape = scene::ToolShape::box;
  capsule.length_m = cylinder.length_m = 3.0 * radius_m;
  box.size_m = radius_m * scene::Vec3(2.0, 1.4, 3.0);
  const auto egg = std::make_shared<scene::Ellipsoid>(scene::Vec3::Zero(), radius_m * scene::Vec3(1.0, 0.7, 1.5));
  mesh.shape = fine.shape = scene::ToolShape::mesh;
  const auto convex = [&](int triangles) {
    auto made = std::make_shared<scene::TriangleMesh>(*mesh_of(*egg, triangles));
    made->convex = true;
    return made;
  };
  mesh.mesh = convex(500);
  fine.mesh = convex(10000);
  std::vector<NamedTool> all{{"Sphere", ball(radius_m), nullptr},
                             {"Capsule", capsule, nullptr},
                             {"Cylinder", cylinder, nullptr},
                             {"Box", box, nullptr},
                             {"Mesh", mesh, egg},
                             {"FineMesh", fine, egg}};
  for (NamedTool& named : all) {
    named.tool.radius_m = radius_m;
    if (named.shape == nullptr) named.shape = scene::tool_shape(named.tool);
  }
  return all;
}

/// Bodies of about 60 mm of every shape.
inline std::vector<NamedBody> four_bodies() {
  std::vector<NamedBody> all{{"Box", {}}, {"Sphere", {}}, {"Ellipsoid", {}}, {"Cylinder", {}}};
  all[0].body.shape = scene::BodyShape::box;
  all[0].body.size_m = scene::Vec3::Constant(0.06);
  all[1].body.shape = scene::BodyShape::sphere;
  all[1].body.radius_m = 0.03;
  all[2].body.shape = scene::BodyShape::ellipsoid;
  all[2].body.semi_axes_m = scene::Vec3(0.04, 0.03, 0.025);
  all[3].body.shape = scene::BodyShape::revolution;
  all[3].body.profile = scene::cylinder_profile(0.03, 0.06, 0.0);
  return all;
}

}  // namespace touchstone::test
