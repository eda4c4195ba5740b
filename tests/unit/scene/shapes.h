// One of every kind of shape, for tests of what all of them promise.
#pragma once

#include "scene/revolution.h"
#include "scene/shape.h"

#include <memory>
#include <string>
#include <vector>

namespace touchstone::scene::test {

struct NamedShape {
  std::string name;
  std::shared_ptr<const Shape> shape;
};

inline std::vector<NamedShape> every_shape() {
  using Vec2 = Eigen::Vector2d;
  const Vec3 place(0.02, -0.01, 0.03);
  const auto revolution = [&](Profile profile) { return std::make_shared<Revolution>(std::move(profile), place); };
  // A lens between two arcs of 50 mm whose centres are off the axis: pointed at both ends.
  const Profile spindle{{Vec2(0, -0.03), Vec2(0.01, 0), Vec2(0, 0.03)}, {0.06, 0.06}};
  const Profile bell{{Vec2(0, 0), Vec2(0.03, 0), Vec2(0.025, 0.02), Vec2(0, 0.03)}, {0, 0, 0.06}};
  return {{"Box", std::make_shared<Box>(Vec3(0.1, -0.2, 0.3), Vec3(0.06, 0.04, 0.08))},
          {"Sphere", std::make_shared<Sphere>(Vec3(-0.1, 0.2, 0.05), 0.03)},
          {"Ellipsoid", std::make_shared<Ellipsoid>(place, Vec3(0.04, 0.025, 0.03))},
          {"OblateEllipsoid", std::make_shared<Ellipsoid>(place, Vec3(0.03, 0.03, 0.015))},
          {"Capsule", revolution(capsule_profile(0.01, 0.03))},
          {"Cylinder", revolution(cylinder_profile(0.02, 0.03, 0.0))},
          {"FilletedCylinder", revolution(cylinder_profile(0.02, 0.03, 0.004))},
          {"Cone", revolution({{Vec2(0, 0), Vec2(0.02, 0), Vec2(0, 0.03)}, {}})},
          {"DoubleCone", revolution({{Vec2(0, -0.02), Vec2(0.02, 0), Vec2(0, 0.03)}, {}})},
          {"Spindle", revolution(spindle)},
          {"Bell", revolution(bell)}};
}

}  // namespace touchstone::scene::test
