#include "scene/response/response.h"

#include "scene/base/hash.h"

#include <iomanip>
#include <sstream>

namespace touchstone::scene {
namespace {

/// Raised with every change of method that moves a response.
constexpr const char* method_version = "touchstone response method 1";

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

template <class Matrix>
std::string hash_of(const Matrix& matrix) {
  return hash_text(
      {reinterpret_cast<const char*>(matrix.data()), static_cast<std::size_t>(matrix.size()) * sizeof *matrix.data()});
}

}  // namespace

std::string response_identity(const Body& body, const LoadGrid& grid, const Surface& surface) {
  std::ostringstream text;
  text << std::setprecision(17) << method_version << "\nbody ";
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
  text << "loads " << grid.counts[0] << " x " << grid.counts[1] << " places " << hash_of(grid.points_m) << '\n'
       << "rest points " << surface.vertex_count() << " places " << hash_of(surface.points_m) << '\n';
  return text.str();
}

}  // namespace touchstone::scene
