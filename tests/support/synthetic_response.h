// A response that no solver computed: smooth functions of the load's place, for tests of what uses one.
#pragma once

#include "scene/response/response.h"
#include "scene/shape/surface.h"

namespace touchstone::test {

/// C(p) = C_m_per_n (1 + 40 x + 900 x^2 - 15 y), sways and tilts beside it, and a displacement of every rest point that
/// is a fraction of C downwards. With friction, sideways loads move the surface 1.5 C their own way and by reciprocity
/// up or down, and the rest points a fraction of that.
inline scene::Response synthetic_response(const scene::Scene& scene, const scene::Surface& surface,
                                          double C_m_per_n = 2e-5) {
  scene::Response out;
  out.grid = scene::load_grid(scene).grid.value();
  const int n = out.grid.count();
  const auto m = surface.points_m.cols();
  out.loads = scene::load_kinds(scene);
  const int columns = out.loads.columns(n);
  out.smooth_m_per_n.setZero(3 * m, columns);
  out.own_m_per_n.setZero(3, columns);
  out.tilt_per_n.resize(2, n);
  for (int k = 0; k < n; ++k) {
    const scene::Vec3 p_m = out.grid.points_m.col(k), normal = out.grid.normals.col(k);
    const double C = C_m_per_n * (1.0 + 40.0 * p_m.x() + 900.0 * p_m.x() * p_m.x() - 15.0 * p_m.y());
    out.own_m_per_n.col(k) = -C * normal + C_m_per_n * (0.3 * out.grid.axes.col(0) - 0.2 * out.grid.axes.col(1));
    out.tilt_per_n.col(k) = Eigen::Vector2d(-60.0, 25.0) * C_m_per_n;
    const Eigen::VectorXf height = (surface.points_m.row(2).transpose() / 0.06).cast<float>();
    out.smooth_m_per_n.col(k).tail(m) = static_cast<float>(-C) * height;
    if (out.loads.ball) out.smooth_m_per_n.col(out.apart(k)).tail(m) = static_cast<float>(300.0 * C) * height;
    if (!out.loads.friction && k != out.grid.middle()) continue;
    const Eigen::Matrix<double, 3, 2> along = out.grid.along(k);
    for (int axis = 0; axis < 2; ++axis) {
      const double sway = out.own_m_per_n.col(k).dot(along.col(axis));
      const scene::Vec3 own = 1.5 * C * along.col(axis) - sway * normal;
      out.own_m_per_n.col(out.along(k, axis)) = own;
      for (Eigen::Index i = 0; i < 3; ++i) {
        out.smooth_m_per_n.col(out.along(k, axis)).segment(i * m, m) = static_cast<float>(own[i]) * height;
      }
    }
  }
  return out;
}

}  // namespace touchstone::test
