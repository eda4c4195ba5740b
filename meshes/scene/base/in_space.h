// Points of a meridian plane in space.
#pragma once

#include "scene/base/frames.h"

namespace touchstone::scene {

/// A point or direction (r, z) of the meridian plane y = 0 in space; one that is in space already as it is.
template <int dim>
[[nodiscard]] Vec3 in_space(const Eigen::Matrix<double, dim, 1>& p) {
  return {p[0], dim == 3 ? p[1] : 0.0, p[dim - 1]};
}

}  // namespace touchstone::scene
