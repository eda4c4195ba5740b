// Surfaces for VTK.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace touchstone::compare {

/// Triangles between points, in double precision.
/// @param points_m  one column per point
[[nodiscard]] vtkSmartPointer<vtkPolyData> polydata_of(const Eigen::Matrix3Xd& points_m,
                                                       const std::vector<std::array<std::int32_t, 3>>& triangles);

}  // namespace touchstone::compare
