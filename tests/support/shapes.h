// One shape of every kind, for tests of their common interface.
#pragma once

#include "scene/shape/solids.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::scene::test {

struct NamedShape {
  std::string name;
  std::shared_ptr<const Shape> shape;
};

inline std::vector<std::pair<std::string, Profile>> profiles() {
  using Vec2 = Eigen::Vector2d;
  return {{"Capsule", capsule_profile(0.01, 0.03)},
          {"Cylinder", cylinder_profile(0.02, 0.03, 0.0)},
          {"FilletedCylinder", cylinder_profile(0.02, 0.03, 0.004)},
          {"Cone", {{Vec2(0, 0), Vec2(0.02, 0), Vec2(0, 0.03)}, {}}},
          {"DoubleCone", {{Vec2(0, -0.02), Vec2(0.02, 0), Vec2(0, 0.03)}, {}}},
          // Arcs whose centres are off the axis: pointed at both ends.
          {"Spindle", {{Vec2(0, -0.03), Vec2(0.01, 0), Vec2(0, 0.03)}, {0.06, 0.06}}},
          {"Bell", {{Vec2(0, 0), Vec2(0.03, 0), Vec2(0.025, 0.02), Vec2(0, 0.03)}, {0, 0, 0.06}}}};
}

inline std::vector<NamedShape> every_shape() {
  const Vec3 place(0.02, -0.01, 0.03);
  std::vector<NamedShape> shapes = {{"Box", std::make_shared<Box>(Vec3(0.1, -0.2, 0.3), Vec3(0.06, 0.04, 0.08))},
                                    {"Sphere", std::make_shared<Sphere>(Vec3(-0.1, 0.2, 0.05), 0.03)},
                                    {"Ellipsoid", std::make_shared<Ellipsoid>(place, Vec3(0.04, 0.025, 0.03))},
                                    {"OblateEllipsoid", std::make_shared<Ellipsoid>(place, Vec3(0.03, 0.03, 0.015))}};
  for (const auto& [name, profile] : profiles()) shapes.push_back({name, std::make_shared<Revolution>(profile, place)});
  return shapes;
}

}  // namespace touchstone::scene::test
