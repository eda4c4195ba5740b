// Bodies of every shape, standing on z = 0, for the tests of anchor points and beams.
#pragma once

#include "scene/model/scene.h"

#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace touchstone::test {

inline scene::Body round_body(scene::Profile profile, double support_height_m = 0.0) {
  scene::Body body;
  body.shape = scene::BodyShape::revolution;
  body.profile = std::move(profile);
  body.support_height_m = support_height_m;
  body.material = {3.0e6, 0.5};
  return body;
}

inline scene::Profile barrel_profile() {
  return {{{0.0, 0.0}, {0.018, 0.0}, {0.018, 0.05}, {0.0, 0.05}}, {0.0, 0.06, 0.0}};
}
inline scene::Profile frustum_profile() { return {{{0.0, 0.0}, {0.025, 0.0}, {0.012, 0.04}, {0.0, 0.04}}, {}}; }
inline scene::Profile cone_profile() { return {{{0.0, 0.0}, {0.025, 0.0}, {0.0, 0.04}}, {}}; }
inline scene::Profile double_cone_profile() { return {{{0.0, 0.0}, {0.03, 0.03}, {0.0, 0.07}}, {}}; }
/// A hemisphere on a disc: one circle, a flat bottom and a dome.
inline scene::Profile dome_profile() { return {{{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.03}}, {0.0, 0.03}}; }
/// A disc whose half-round rim is written as two arcs of one circle.
inline scene::Profile pill_profile() {
  return {{{0.0, 0.0}, {0.02, 0.0}, {0.03, 0.01}, {0.02, 0.02}, {0.0, 0.02}}, {0.0, 0.01, 0.01, 0.0}};
}
/// A sphere as two arcs that do not meet on its equator.
inline scene::Profile sphere_profile() {
  return {{{0.0, 0.0}, {0.03 * std::sin(1.2), 0.03 - 0.03 * std::cos(1.2)}, {0.0, 0.06}}, {0.03, 0.03}};
}
/// A dome of two arcs of one circle on a cylinder on a dome.
inline scene::Profile long_capsule_profile() {
  const double r = 0.02, c = r * std::cos(0.8), s = r * std::sin(0.8);
  return {{{0.0, 0.0}, {r * std::sin(0.5), r - r * std::cos(0.5)}, {r, r}, {r, 0.05}, {c, 0.05 + s}, {0.0, 0.07}},
          {r, r, 0.0, r, r}};
}

struct NamedBody {
  std::string name;
  scene::Body body;
};
inline void PrintTo(const NamedBody& named, std::ostream* out) { *out << named.name; }

/// Every shape, with every kind of support.
inline std::vector<NamedBody> bodies() {
  scene::Body box, sphere, ellipsoid;
  box.shape = scene::BodyShape::box;
  box.size_m = scene::Vec3(0.06, 0.05, 0.04);
  sphere.shape = scene::BodyShape::sphere;
  sphere.radius_m = 0.03;
  sphere.support_height_m = 0.005;
  ellipsoid.shape = scene::BodyShape::ellipsoid;
  ellipsoid.semi_axes_m = scene::Vec3(0.04, 0.03, 0.02);
  ellipsoid.support_height_m = 0.006;
  return {{"box", box},
          {"sphere", sphere},
          {"ellipsoid", ellipsoid},
          {"cylinder", round_body(scene::cylinder_profile(0.02, 0.05, 0.0))},
          {"rounded cylinder", round_body(scene::cylinder_profile(0.02, 0.05, 0.004))},
          {"frustum", round_body(frustum_profile())},
          {"cone", round_body(cone_profile())},
          {"barrel", round_body(barrel_profile())},
          {"dome", round_body(dome_profile())},
          {"pill", round_body(pill_profile())},
          {"capsule, held below its circle", round_body(scene::capsule_profile(0.02, 0.03), 0.006)},
          {"capsule, held above its circle", round_body(scene::capsule_profile(0.02, 0.03), 0.03)},
          {"capsule, held up to its circle", round_body(scene::capsule_profile(0.02, 0.03), 0.02)},
          {"capsule, held above both circles", round_body(scene::capsule_profile(0.02, 0.03), 0.055)},
          {"capsule on its lowest point", round_body(scene::capsule_profile(0.02, 0.03))},
          {"capsule of five pieces", round_body(long_capsule_profile(), 0.006)},
          {"capsule of five pieces, held high", round_body(long_capsule_profile(), 0.066)},
          {"double cone", round_body(double_cone_profile(), 0.01)},
          {"double cone, held above its circle", round_body(double_cone_profile(), 0.04)},
          {"sphere by its profile", round_body(sphere_profile(), 0.004)}};
}

}  // namespace touchstone::test
