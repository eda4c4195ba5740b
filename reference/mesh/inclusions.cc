#include "reference/mesh/inclusions.h"

#include "reference/discretisation/shape.h"
#include "scene/base/in_space.h"
#include "scene/model/solid_kinds.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

namespace touchstone::reference {
namespace {

using scene::Inclusion;
using scene::Vec3;

bool revolved_about_own_axis(const scene::Solid& solid) {
  const scene::SolidKind& kind = scene::kind_of(solid);
  if (kind.turned == nullptr) return false;
  const Eigen::Vector2d stretch = kind.turned(solid).stretch;
  return stretch.x() == stretch.y();
}

bool alike(const Inclusion& a, const Inclusion& b) {
  const auto key = [](const Inclusion& i) {
    return std::tie(i.shape, i.radius_m, i.profile.arc_radius_m, i.material.youngs_modulus_pa,
                    i.material.poissons_ratio);
  };
  return key(a) == key(b) && a.size_m == b.size_m && a.semi_axes_m == b.semi_axes_m && a.profile.rz_m == b.profile.rz_m;
}

}  // namespace

template <int dim>
void embed_inclusions(const scene::Body& body, Discretisation<dim>& mesh) {
  if (body.inclusions.empty()) return;
  std::vector<std::unique_ptr<const scene::Shape>> shapes;
  for (const Inclusion& inclusion : body.inclusions) {
    shapes.push_back(solid_shape(inclusion, inclusion.center_m));
    mesh.inclusion_materials.push_back(inclusion.material);
  }
  if (!mesh.materials.empty()) return;  // the cells follow
  for (const CellGeometry<dim>& cell : mesh.cell_geometry()) {
    auto& materials = mesh.materials.emplace_back();
    for (std::size_t q = 0; q < materials.size(); ++q) {
      const Vec3 place_m = scene::in_space<dim>(cell.place_m[q]);
      const auto inside = std::find_if(shapes.begin(), shapes.end(),
                                       [&](const auto& shape) { return shape->signed_distance_m(place_m) < 0.0; });
      materials[q] = inside == shapes.end() ? 0 : static_cast<std::uint8_t>(inside - shapes.begin() + 1);
    }
  }
}

template <int dim>
void refine_at_inclusions(const scene::Body& body, double cells, Grading<dim>& grading) {
  for (const Inclusion& inclusion : body.inclusions) {
    const std::shared_ptr<const scene::Shape> shape = solid_shape(inclusion, inclusion.center_m);
    grading.sets.push_back({[shape](const Eigen::Matrix<double, dim, 1>& x_m) {
                              return shape->signed_distance_m(scene::in_space<dim>(x_m));
                            },
                            -shape->signed_distance_m(inclusion.center_m) / cells});
  }
}

template <int dim>
void refine_at_inclusions(const FollowingGrid<dim>& coarse, double cells, int more, Grading<dim>& grading) {
  // Bent parts of a cell are not exactly half as large.
  constexpr double about = 1.2;
  for (std::size_t k = 0; k < coarse.shapes.size(); ++k) {
    if (coarse.edge_m[k] == 0.0) continue;  // its mirror image is meshed
    const std::shared_ptr<const scene::Shape> shape = coarse.shapes[k];
    const double wished_m = coarse.radius_m[k] / cells;
    const int first = std::max(0, static_cast<int>(std::ceil(std::log2(coarse.edge_m[k] / (about * wished_m)))));
    const int divisions = first + more;
    grading.sets.push_back({[shape](const Eigen::Matrix<double, dim, 1>& x_m) {
                              return shape->signed_distance_m(scene::in_space<dim>(x_m));
                            },
                            about * coarse.edge_m[k] / std::exp2(divisions), divisions});
  }
}

bool revolved(const scene::Body& body) {
  return revolved_about_own_axis(body) &&
         std::all_of(body.inclusions.begin(), body.inclusions.end(), [](const Inclusion& inclusion) {
           return inclusion.center_m.x() == 0.0 && inclusion.center_m.y() == 0.0 && revolved_about_own_axis(inclusion);
         });
}

bool mirrored(const std::vector<Inclusion>& inclusions, int axis) {
  return std::all_of(inclusions.begin(), inclusions.end(), [&](const Inclusion& one) {
    return std::any_of(inclusions.begin(), inclusions.end(), [&](const Inclusion& other) {
      Vec3 image_m = other.center_m;
      image_m[axis] *= -1.0;
      return image_m == one.center_m && alike(one, other);
    });
  });
}

template void embed_inclusions(const scene::Body&, Discretisation<2>&);
template void embed_inclusions(const scene::Body&, Discretisation<3>&);
template void refine_at_inclusions(const scene::Body&, double, Grading<2>&);
template void refine_at_inclusions(const scene::Body&, double, Grading<3>&);
template void refine_at_inclusions(const FollowingGrid<2>&, double, int, Grading<2>&);
template void refine_at_inclusions(const FollowingGrid<3>&, double, int, Grading<3>&);

}  // namespace touchstone::reference
