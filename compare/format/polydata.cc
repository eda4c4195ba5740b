#include "compare/format/polydata.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

namespace touchstone::compare {

vtkSmartPointer<vtkPolyData> polydata_of(const Eigen::Matrix3Xd& points_m,
                                         const std::vector<std::array<std::int32_t, 3>>& triangles) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& p : points_m.colwise()) points->InsertNextPoint(p.x(), p.y(), p.z());
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : triangles) {
    const vtkIdType corners[] = {a, b, c};
    cells->InsertNextCell(3, corners);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

}  // namespace touchstone::compare
