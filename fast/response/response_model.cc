#include "fast/response/response_model.h"

#include "scene/response/find_tips.h"
#include "scene/response/point_load.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Vec3;

bool alike(const LocalShape& a, const LocalShape& b, double reach_m) {
  constexpr double tolerance = 1e-6;  // of the height at the reach, over the reach
  return std::abs(a.height_m(reach_m) - b.height_m(reach_m)) < tolerance * reach_m;
}

TipLaw tip_law(const scene::Body& body, const scene::Shape& shape, const scene::LoadGrid& grid,
               const scene::ToolTip& tip) {
  TipLaw out{.tip = tip, .local = {}, .tables = {}};
  // At most a radius apart.
  if (tip.line()) out.patches = 1 + 2 * static_cast<int>(std::ceil(tip.half_line_T_m.norm() / tip.radius_m));
  const double reach_m = tip.reach_m();
  for (int k = 0; k < grid.count(); ++k) {
    out.local.push_back(local_shape(shape, grid.points_m.col(k), grid.normals.col(k), 0.8 * reach_m));
  }
  const bool same = std::all_of(out.local.begin(), out.local.end(),
                                [&](const LocalShape& one) { return alike(one, out.local.front(), reach_m); });
  const FiniteStrain strain = finite_strain(body.material.poissons_ratio);
  for (int k = 0; k < (same ? 1 : grid.count()); ++k) {
    out.tables.emplace_back(tip, out.local[static_cast<std::size_t>(k)], body.material.contact_modulus_pa(), strain);
  }
  return out;
}

/// From a point of the surface to the nearest edge of its face, along its tangent plane [m]; far beyond the body where
/// the face has none.
double to_edge_m(const scene::Shape& body, const Vec3& point_m, const Vec3& normal, double size_m) {
  const int face = body.face_of(body.query(point_m).patch);
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  double nearest_m = 100.0 * size_m;
  constexpr int directions = 64;
  for (int d = 0; d < directions; ++d) {
    const double angle = 2.0 * std::numbers::pi * d / directions;
    const Vec3 along = std::cos(angle) * first + std::sin(angle) * second;
    // Down to the surface, or nothing beside the body.
    const auto below = [&](double r_m) -> std::optional<scene::SurfaceQuery> {
      const Vec3 from_m = point_m + r_m * along + 2.0 * size_m * normal;
      const scene::Crossing inside = body.crossing(from_m, from_m - 4.0 * size_m * normal);
      if (inside.empty()) return std::nullopt;
      return body.query(from_m - inside.enter_m * normal);
    };
    const auto on_face = [&](double r_m) {
      const std::optional<scene::SurfaceQuery> at = below(r_m);
      return at && body.face_of(at->patch) == face;
    };
    double low_m = 0.0, high_m = 4.0 * size_m;
    for (int k = 0; k < 40; ++k) {
      const double middle_m = 0.5 * (low_m + high_m);
      (on_face(middle_m) ? low_m : high_m) = middle_m;
    }
    // Where the surface has turned away by as much as the line, this is its outline and no edge.
    const std::optional<scene::SurfaceQuery> last = below(low_m);
    constexpr double outline = 0.01;  // cosine
    if (last && last->normal.dot(normal) > outline) nearest_m = std::min(nearest_m, low_m);
  }
  return nearest_m;
}

/// The largest curvature of a smooth face at a point, without its sign.
double curvature_per_m(const scene::Shape& body, const Vec3& point_m, const Vec3& normal, double step_m) {
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  double largest_per_m = 0.0;
  constexpr int directions = 16;
  for (int d = 0; d < directions; ++d) {
    const double angle = std::numbers::pi * d / directions;
    const Vec3 along = std::cos(angle) * first + std::sin(angle) * second;
    const scene::SurfaceQuery low = body.query(point_m - step_m * along), high = body.query(point_m + step_m * along);
    largest_per_m = std::max(largest_per_m, std::abs((high.normal - low.normal).dot(along)) / (2.0 * step_m));
  }
  return largest_per_m;
}

/// Corners of the triangle of a surface that holds a point of it, and their shares.
struct OnTriangle {
  std::array<std::int32_t, 3> corners{};
  Vec3 shares = Vec3::Zero();
};

/// @param normal  of the surface there: of those on its side it is the triangle whose inside the point is deepest in
OnTriangle on_triangle(const scene::Surface& surface, const Vec3& point_m, const Vec3& normal) {
  OnTriangle out;
  double best = -INFINITY;
  for (const auto& corners : surface.triangles) {
    const Vec3 a = surface.points_m.col(corners[0]), b = surface.points_m.col(corners[1]),
               c = surface.points_m.col(corners[2]);
    const double all = (b - a).cross(c - a).dot(normal);
    if (!(all > 0.0)) continue;
    const Vec3 shares(Vec3(c - b).cross(point_m - b).dot(normal) / all,
                      Vec3(a - c).cross(point_m - c).dot(normal) / all,
                      Vec3(b - a).cross(point_m - a).dot(normal) / all);
    if (shares.minCoeff() <= best) continue;
    best = shares.minCoeff();
    out = {corners, shares};
  }
  return out;
}

/// Normal displacement at each grid point by a load at each other one, less (1 - nu^2) / (pi E |p - q|), from the
/// columns at the rest points. Both directions are the same but for the columns' errors, which the mean halves.
Eigen::MatrixXd cross_compliance_m_per_n(const scene::Response& response, const scene::Surface& surface,
                                         const scene::Material& material, const HalfSpace& half_space) {
  const scene::LoadGrid& grid = response.grid;
  const int n = grid.count();
  const auto m = surface.points_m.cols();
  Eigen::MatrixXd out(n, n);
  for (int k = 0; k < n; ++k) {
    const Vec3 p_m = grid.points_m.col(k), normal = grid.normals.col(k);
    const OnTriangle at = on_triangle(surface, p_m, normal);
    for (int j = 0; j < n; ++j) {
      if (j == k) {
        out(k, k) = -response.own_m_per_n.col(k).dot(normal);
        continue;
      }
      const Vec3 q_m = grid.points_m.col(j);
      Vec3 u_m = scene::half_space_displacement_m({.point_m = q_m, .normal = grid.normals.col(j)}, material, p_m);
      for (std::size_t corner = 0; corner < 3; ++corner) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          u_m[axis] += at.shares[static_cast<Eigen::Index>(corner)] *
                       static_cast<double>(response.smooth_m_per_n(axis * m + at.corners[corner], j));
        }
      }
      out(k, j) = -u_m.dot(normal) - half_space.surface_m2_per_n() / (p_m - q_m).norm();
    }
  }
  return 0.5 * (out + out.transpose());
}

}  // namespace

ResponseModel::ResponseModel(const scene::Scene& scene, scene::Surface at_rest, scene::Response given)
    : body(scene::body_shape(scene.body)),
      surface(std::move(at_rest)),
      response(std::move(given)),
      half_space(scene.body.material),
      field(scene.body.material.poissons_ratio),
      rest_m(columns_of(surface.points_m)),
      rest_normal(columns_of(surface.normals)),
      normals(normal_stencils(surface)),
      falloff_per_m(scene.fast.body_falloff_per_m) {
  const scene::LoadGrid& grid = response.grid;
  const int n = grid.count();
  body_size_m = scene::body_size_m(scene.body);
  edge_distance_m.resize(n);
  largest_curvature_per_m.resize(n);
  own_compliance.resize(n);
  sway.resize(3, n);
  tilt.resize(3, n);
  for (int k = 0; k < n; ++k) {
    const Vec3 normal = grid.normals.col(k), own = response.own_m_per_n.col(k);
    own_compliance[k] = -own.dot(normal);
    sway.col(k) = own - own.dot(normal) * normal;
    const Vec3 slope = grid.axes.leftCols<2>() * response.tilt_per_n.col(k);
    tilt.col(k) = slope - slope.dot(normal) * normal;
    edge_distance_m[k] = to_edge_m(*body, grid.points_m.col(k), normal, body_size_m);
    largest_curvature_per_m[k] = curvature_per_m(*body, grid.points_m.col(k), normal, 0.01 * body_size_m);
  }
  for (const scene::ToolTip& tip : scene::tool_tips(scene).tips) {
    tips.push_back(tip_law(scene.body, *body, grid, tip));
  }
  checked = checked_range(scene);
  if (tips.size() > 1) {
    cross_compliance = cross_compliance_m_per_n(response, surface, scene.body.material, half_space);
  }
  if (scene.contact.friction) {
    springs.emplace(*scene.contact.friction, scene.body.material.poissons_ratio, tips.front().tables.front());
    for (int k = 0; k < n; ++k) {
      const Eigen::Matrix<double, 3, 2> along = grid.along(k);
      const Eigen::Matrix2d own = along.transpose() * response.own_m_per_n.middleCols<2>(response.along(k, 0));
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
                      static_cast<std::size_t>(own_compliance.size()) * (3 + 6 + 9) * sizeof(double) +
                      static_cast<std::size_t>(cross_compliance.size()) * sizeof(double);
  for (const TipLaw& law : tips) {
    bytes += law.local.size() * sizeof(LocalShape);
    for (const ContactTable& table : law.tables) bytes += table.memory_bytes();
  }
  if (springs) bytes += springs->memory_bytes() + shear_compliance.size() * sizeof(Eigen::Matrix3d);
  return bytes;
}

ResponseState::ResponseState(const ResponseModel& model)
    : contacts(model.tips.size()),
      field(model.rest_normal),
      near(model.rest_m[0].size() * model.tips.size()),
      near_count(model.tips.size()),
      column_weight(model.response.grid.count()),
      slip(model.springs ? std::make_unique<SlipState>() : nullptr) {
  if (model.tips.size() > 1 || model.tips.front().tip.line()) other_m = model.rest_m;
}

std::size_t ResponseState::memory_bytes() const noexcept {
  return contacts.size() * sizeof(ResponseContact) + field.memory_bytes() + near.size() * sizeof(std::int32_t) +
         3 * other_m[0].size() * sizeof(float) + static_cast<std::size_t>(column_weight.size()) * sizeof(double) +
         (slip ? sizeof(SlipState) : 0);
}

}  // namespace touchstone::fast
