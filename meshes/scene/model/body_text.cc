#include "scene/model/body_text.h"

#include "scene/base/index.h"
#include "scene/model/solid_kinds.h"

#include <iomanip>
#include <sstream>

namespace touchstone::scene {
namespace {

/// A solid with a name counts as its profile.
void add_solid(const Solid& solid, std::ostream& text) {
  const SolidKind& kind = nth(solid_kinds(), solid.shape);
  struct Visitor {
    const Solid& solid;
    std::ostream& text;
    void operator()(double Solid::*length_m) const { text << ' ' << solid.*length_m; }
    void operator()(Vec3 Solid::*lengths_m) const { text << ' ' << (solid.*lengths_m).transpose(); }
    void operator()(Profile Solid::*profile) const {
      for (const Eigen::Vector2d& corner_m : (solid.*profile).rz_m) text << " (" << corner_m.transpose() << ')';
      for (const double radius_m : (solid.*profile).arc_radius_m) text << ' ' << radius_m;
    }
  };
  text << kind.word;
  for (const SolidLength& length : kind.lengths) std::visit(Visitor{solid, text}, length);
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
