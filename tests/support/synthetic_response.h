// A response that no solver computed: smooth functions of the load's place, for tests of what uses one.
#pragma once

#include "scene/response/response.h"
#include "scene/shape/surface.h"

namespace touchstone::test {

/// C(p) = C_m_per_n (1 + 40 x + 900 x^2 - 15 y), sways and tilts beside it, and a displacement of every rest point that
/// is a fraction of C downwards.
inline scene::Response synthetic_response(const scene::Scene& scene, const scene::Surface& surface,
                                          double C_m_per_n = 2e-5) {
  scene::Response out;
  out.grid = scene::load_grid(scene).grid.value();
  const int n = out.grid.count();
  const auto m = surface.points_m.cols();
  out.smooth_m_per_n.resize(3 * m, n);
  out.own_m_per_n.resize(3, n);
  out.tilt_per_n.resize(2, n);
  for (int k = 0; k < n; ++k) {
    const scene::Vec3 p_m = out.grid.points_m.col(k), normal = out.grid.normals.col(k);
    const double C = C_m_per_n * (1.0 + 40.0 * p_m.x() + 900.0 * p_m.x() * p_m.x() - 15.0 * p_m.y());
    out.own_m_per_n.col(k) = -C * normal + C_m_per_n * (0.3 * out.grid.axes.col(0) - 0.2 * out.grid.axes.col(1));
    out.tilt_per_n.col(k) = Eigen::Vector2d(-60.0, 25.0) * C_m_per_n;
    out.smooth_m_per_n.col(k).head(2 * m).setZero();
    out.smooth_m_per_n.col(k).tail(m) = (-C * surface.points_m.row(2).transpose() / 0.06).cast<float>();
  }
  return out;
}

}  // namespace touchstone::test
