#include "fast/response/response_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Vec3;

bool alike(const LocalShape& a, const LocalShape& b, double reach_m) {
  constexpr double tolerance = 1e-6;  // of the height at the reach, over the reach
  return std::abs(a.height_m(reach_m) - b.height_m(reach_m)) < tolerance * reach_m;
}

}  // namespace

ResponseModel::ResponseModel(const scene::Scene& scene, scene::Surface at_rest, scene::Response given)
    : body(scene::body_shape(scene.body)),
      surface(std::move(at_rest)),
      tip(scene::tool_tip(scene).tip.value()),
      response(std::move(given)),
      half_space(scene.body.material),
      rest_m(columns_of(surface.points_m)),
      rest_normal(columns_of(surface.normals)),
      normals(normal_stencils(surface)) {
  const scene::LoadGrid& grid = response.grid;
  const int n = grid.count();
  const double reach_m = tip.reach_m();
  own_compliance.resize(n);
  sway.resize(3, n);
  tilt.resize(3, n);
  for (int k = 0; k < n; ++k) {
    const Vec3 normal = grid.normals.col(k), own = response.own_m_per_n.col(k);
    own_compliance[k] = -own.dot(normal);
    sway.col(k) = own - own.dot(normal) * normal;
    const Vec3 slope = grid.axes.leftCols<2>() * response.tilt_per_n.col(k);
    tilt.col(k) = slope - slope.dot(normal) * normal;
    local.push_back(local_shape(*body, grid.points_m.col(k), normal, 0.8 * reach_m));
  }
  const bool same = std::all_of(local.begin(), local.end(),
                                [&](const LocalShape& one) { return alike(one, local.front(), reach_m); });
  const FiniteStrain strain = finite_strain(scene.body.material.poissons_ratio);
  for (int k = 0; k < (same ? 1 : n); ++k) {
    tables.emplace_back(tip, local[static_cast<std::size_t>(k)], scene.body.material.contact_modulus_pa(), strain);
  }
  if (scene.contact.friction) {
    springs.emplace(*scene.contact.friction, scene.body.material.poissons_ratio, tables.front());
    for (int k = 0; k < n; ++k) {
      const Eigen::Matrix<double, 3, 2> along = grid.along(k);
      const Eigen::Matrix2d own = along.transpose() * response.own_m_per_n.middleCols<2>(n + 2 * k);
      shear_compliance.emplace_back(along * (0.5 * (own + own.transpose())) * along.transpose());
    }
  }
  const double held_below_m = scene.body.flat_bottom() ? 0.0 : scene.body.support_height_m;
  const double touching_m = 1e-9 * scene::body_size_m(scene.body);
  for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
    free.push_back(surface.points_m(2, i) <= held_below_m + touching_m ? 0.0f : 1.0f);
  }
}

std::size_t ResponseModel::memory_bytes() const noexcept {
  std::size_t bytes = (rest_m[0].size() * 6 + free.size()) * sizeof(float) + normals.memory_bytes() +
                      static_cast<std::size_t>(response.smooth_m_per_n.size()) * sizeof(float) +
                      static_cast<std::size_t>(own_compliance.size()) * (1 + 6 + 11) * sizeof(double);
  for (const ContactTable& table : tables) bytes += table.memory_bytes();
  if (springs) bytes += springs->memory_bytes() + shear_compliance.size() * sizeof(Eigen::Matrix3d);
  return bytes;
}

ResponseState::ResponseState(const ResponseModel& model)
    : field(model.rest_normal),
      near(model.rest_m[0].size()),
      slip(model.springs ? std::make_unique<SlipState>() : nullptr) {}

std::size_t ResponseState::memory_bytes() const noexcept {
  return field.memory_bytes() + near.size() * sizeof(std::int32_t) + (slip ? sizeof(SlipState) : 0);
}

}  // namespace touchstone::fast
