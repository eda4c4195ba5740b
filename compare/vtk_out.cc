#include "compare/vtk_out.h"

#include "scene/results.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <functional>
#include <string>

namespace touchstone::compare {
namespace {

void add_vectors(vtkPolyData* data, const char* name, const Eigen::Matrix3Xd& vectors) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(3);
  for (const auto& v : vectors.colwise()) array->InsertNextTuple3(v.x(), v.y(), v.z());
  data->GetPointData()->AddArray(array);
}

void add_numbers(vtkPolyData* data, const char* name, const Eigen::VectorXd& numbers) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  for (const double v : numbers) array->InsertNextValue(v);
  data->GetPointData()->AddArray(array);
}

void add_region(vtkPolyData* data, const char* name, const std::vector<bool>& touched) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  for (const bool touches : touched) array->InsertNextValue(touches ? 0 : -1);
  data->GetPointData()->AddArray(array);
}

std::string file_name(std::size_t instant) { return fmt::format("surface_{:04}.vtp", instant); }

/// Writes one file per instant and the collection; `add_arrays(instant, data)` puts the point arrays in.
void write_series(const std::filesystem::path& folder, const scene::Surface& surface,
                  const std::vector<scene::InstantRecord>& instants,
                  const std::function<void(std::size_t, vtkPolyData*)>& add_arrays) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& p : surface.points_m.colwise()) points->InsertNextPoint(p.x(), p.y(), p.z());
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : surface.triangles) {
    const vtkIdType corners[] = {a, b, c};
    cells->InsertNextCell(3, corners);
  }

  std::string collection =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
      "<Collection>\n";
  for (std::size_t t = 0; t < instants.size(); ++t) {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    add_arrays(t, data);

    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(data);
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    writer->WriteToOutputStringOn();
    writer->Write();
    scene::write_file(folder / file_name(t), writer->GetOutputString());
    collection +=
        fmt::format("    <DataSet timestep=\"{:.17g}\" part=\"0\" file=\"{}\"/>\n", instants[t].time_s, file_name(t));
  }
  scene::write_file(folder / "surface.pvd", collection + "  </Collection>\n</VTKFile>\n");
  for (std::size_t t = instants.size(); std::filesystem::remove(folder / file_name(t)); ++t) {
  }
}

}  // namespace

void write_surfaces(const std::filesystem::path& folder, const fast::Run& run, const reference::Result& result,
                    const Errors& errors) {
  write_series(folder, run.surface, run.instants, [&](std::size_t t, vtkPolyData* data) {
    const Eigen::Matrix3Xd& fast_m = run.instants[t].displacement_m;
    const Eigen::Matrix3Xd& reference_m = result.instants[t].displacement_m;
    const Eigen::Matrix3Xd error_m = fast_m - reference_m;
    add_vectors(data, "displacement_fast_m", fast_m);
    add_vectors(data, "displacement_reference_m", reference_m);
    add_vectors(data, "displacement_error_m", error_m);
    add_numbers(data, "displacement_error_magnitude_m", error_m.colwise().norm().transpose());
    add_numbers(data, "displacement_reference_uncertainty_m", result.displacement_uncertainty_m[t]);
    add_vectors(data, "normal_fast", run.normals[t]);
    add_region(data, "region_id_fast", errors.instants[t].touched_fast);
    add_region(data, "region_id_reference", errors.instants[t].touched_reference);
  });
}

void write_fast_surfaces(const std::filesystem::path& folder, const fast::Run& run) {
  write_series(folder, run.surface, run.instants, [&](std::size_t t, vtkPolyData* data) {
    add_vectors(data, "displacement_m", run.instants[t].displacement_m);
    add_vectors(data, "normal", run.normals[t]);
  });
}

void write_reference_surfaces(const std::filesystem::path& folder, const scene::Surface& surface,
                              const reference::Result& result) {
  write_series(folder, surface, result.instants, [&](std::size_t t, vtkPolyData* data) {
    add_vectors(data, "displacement_m", result.instants[t].displacement_m);
    add_numbers(data, "displacement_uncertainty_m", result.displacement_uncertainty_m[t]);
  });
}

}  // namespace touchstone::compare
