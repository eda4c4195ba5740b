#include "scene/response/load_grid.h"

#include "scene/response/find_tips.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::scene {
namespace {

/// Largest distance of two columns over the body's size: with a sixth of this the interpolation between them is off by
/// 0.1 % and less, next to an edge by more.
constexpr double spacing_rel = 0.1;

/// Room around the track for the load's shift, over the body's size.
constexpr double margin_rel = 0.05;

/// The surface below a point, along a direction into the body.
std::optional<SurfaceQuery> below(const Shape& body, const Vec3& p_m, const Vec3& normal, double size_m) {
  const Vec3 from_m = p_m + size_m * normal, to_m = p_m - 0.5 * size_m * normal;
  const Crossing inside = body.crossing(from_m, to_m);
  if (inside.empty()) return std::nullopt;
  return body.query(from_m - inside.enter_m * normal);
}

}  // namespace

FoundGrid load_grid(const Scene& scene) {
  const FoundTips found = tool_tips(scene);
  if (!found.why.empty()) return {{}, found.why};
  const auto body = body_shape(scene.body);
  const double size_m = body_size_m(scene.body);
  std::vector<Touch> touches;
  for (const double time_s : looked_at_s(scene)) {
    for (const ToolTip& tip : found.tips) {
      const Pose pose = pose_at(scene.track, time_s);
      if (touch(*body, tip, pose).depth_m <= 0.0) continue;
      for (const double side : {-1.0, 1.0}) {  // of a line
        ToolTip end = tip;
        end.center_T_m += side * tip.half_line_T_m;
        touches.push_back(touch(*body, end, pose));
        if (!tip.line()) break;
      }
    }
  }
  if (touches.empty()) return {{}, "the tool touches the body"};

  Vec3 normal = Vec3::Zero(), middle_m = Vec3::Zero();
  for (const Touch& at : touches) normal += at.normal;
  if (normal.norm() < 0.8 * static_cast<double>(touches.size())) return {{}, "its track stays on one side of the body"};
  normal.normalize();
  // Along the world's x where the surface allows it.
  const Vec3 across = std::abs(normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 first = (across - across.dot(normal) * normal).normalized();
  LoadGrid grid;
  grid.axes << first, normal.cross(first), normal;
  Eigen::Vector2d low_m = Eigen::Vector2d::Constant(INFINITY), high_m = -low_m;
  for (const Touch& at : touches) {
    const Eigen::Vector2d along_m = grid.axes.leftCols<2>().transpose() * at.point_m;
    low_m = low_m.cwiseMin(along_m);
    high_m = high_m.cwiseMax(along_m);
  }
  middle_m = grid.axes.leftCols<2>() * (0.5 * (low_m + high_m)) + normal * normal.dot(touches.front().point_m);
  const std::optional<SurfaceQuery> foot = below(*body, middle_m, normal, size_m);
  if (!foot) return {{}, "its track stays on one side of the body"};
  grid.middle_m = foot->point_m;
  const int face = body->face_of(foot->patch);
  for (std::size_t i = 0; i < 2; ++i) {
    const double half_m = 0.5 * (high_m - low_m)[static_cast<Eigen::Index>(i)] + margin_rel * size_m;
    grid.counts[i] = std::max(3, static_cast<int>(std::ceil(2.0 * half_m / (spacing_rel * size_m) - 1e-9)) + 1);
    grid.spacing_m[i] = 2.0 * half_m / (grid.counts[i] - 1);
  }
  constexpr int columns_max = 400;
  if (grid.count() > columns_max) return {{}, fmt::format("its track needs at most {} columns", columns_max)};
  grid.points_m.resize(3, grid.count());
  grid.normals.resize(3, grid.count());
  for (int k = 0; k < grid.count(); ++k) {
    const int column = k % grid.counts[0], row = k / grid.counts[0];
    const double i = column - 0.5 * (grid.counts[0] - 1), j = row - 0.5 * (grid.counts[1] - 1);
    const Vec3 p_m =
        grid.middle_m + i * grid.spacing_m[0] * grid.axes.col(0) + j * grid.spacing_m[1] * grid.axes.col(1);
    const std::optional<SurfaceQuery> at = below(*body, p_m, normal, size_m);
    if (!at || body->face_of(at->patch) != face) {
      return {{}, fmt::format("its contacts keep {:.3g} mm from the edges of the body", 1e3 * margin_rel * size_m)};
    }
    grid.points_m.col(k) = at->point_m;
    grid.normals.col(k) = at->normal;
  }
  return {std::move(grid), ""};
}

}  // namespace touchstone::scene
