#include "scene/model/body_text.h"

#include <iomanip>
#include <sstream>

namespace touchstone::scene {
namespace {

void add_solid(const Solid& solid, std::ostream& text) {
  switch (solid.shape) {
    case BodyShape::box:
      text << "box " << solid.size_m.transpose();
      break;
    case BodyShape::sphere:
      text << "sphere " << solid.radius_m;
      break;
    case BodyShape::ellipsoid:
      text << "ellipsoid " << solid.semi_axes_m.transpose();
      break;
    case BodyShape::revolution:
      text << "revolution";
      for (const Eigen::Vector2d& corner_m : solid.profile.rz_m) text << " (" << corner_m.transpose() << ')';
      for (const double radius_m : solid.profile.arc_radius_m) text << ' ' << radius_m;
      break;
  }
  text << '\n';
}

}  // namespace

std::string body_text(const Body& body) {
  std::ostringstream text;
  text << std::setprecision(17) << "body ";
  const auto add_material = [&](const Material& material) {
    text << "E " << material.youngs_modulus_pa << " nu " << material.poissons_ratio << '\n';
  };
  add_solid(body, text);
  if (!body.flat_bottom()) text << "held below " << body.support_height_m << '\n';
  add_material(body.material);
  for (const Inclusion& inclusion : body.inclusions) {
    text << "inclusion at " << inclusion.center_m.transpose() << ' ';
    add_solid(inclusion, text);
    add_material(inclusion.material);
  }
  return text.str();
}

}  // namespace touchstone::scene
