#include "compare/report/vtk_out.h"

#include "compare/format/polydata.h"
#include "scene/output/results.h"

#include <fmt/format.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataWriter.h>

#include <functional>
#include <string>

namespace touchstone::compare {
namespace {

/// Triangles of an analytic tool, enough to look round.
constexpr int vtk_tool_triangles = 3000;

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

void add_traction(vtkPolyData* data, const scene::ReferenceInstant& instant, const std::string& name) {
  if (instant.traction_pa.size() == 0) return;
  add_vectors(data, (name + "_pa").c_str(), instant.traction_pa);
  add_numbers(data, (name + "_uncertainty_pa").c_str(), instant.traction_uncertainty_pa);
}

void add_region(vtkPolyData* data, const char* name, const std::vector<bool>& touched) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  for (const bool touches : touched) array->InsertNextValue(touches ? 0 : -1);
  data->GetPointData()->AddArray(array);
}

/// Writes <name>_0000.<ending> ..., one file per instant, and the collection <name>.pvd.
/// @param bytes  of the file of an instant
void write_series(const std::filesystem::path& folder, const std::string& name, const std::string& ending,
                  const scene::Instants& instants, const std::function<std::string(std::size_t)>& bytes) {
  const auto file_name = [&](std::size_t instant) { return fmt::format("{}_{:04}.{}", name, instant, ending); };
  std::string collection =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
      "<Collection>\n";
  for (std::size_t t = 0; t < instants.size(); ++t) {
    scene::write_file(folder / file_name(t), bytes(t));
    collection +=
        fmt::format("    <DataSet timestep=\"{:.17g}\" part=\"0\" file=\"{}\"/>\n", instants[t].time_s, file_name(t));
  }
  scene::write_file(folder / (name + ".pvd"), collection + "  </Collection>\n</VTKFile>\n");
  for (std::size_t t = instants.size(); std::filesystem::remove(folder / file_name(t)); ++t) {
  }
}

/// The same of surfaces.
/// @param at  the surface at an instant
void write_surface_series(const std::filesystem::path& folder, const std::string& name, const scene::Instants& instants,
                          const std::function<vtkSmartPointer<vtkPolyData>(std::size_t)>& at) {
  write_series(folder, name, "vtp", instants, [&](std::size_t t) {
    vtkNew<vtkXMLPolyDataWriter> writer;
    const vtkSmartPointer<vtkPolyData> data = at(t);
    writer->SetInputData(data);
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1);
    writer->WriteToOutputStringOn();
    writer->Write();
    return writer->GetOutputString();
  });
}

/// Writes the body's rest surface; `add_arrays(instant, data)` adds its point arrays.
void write_body(const std::filesystem::path& folder, const scene::Surface& surface, const scene::Instants& instants,
                const std::function<void(std::size_t, vtkPolyData*)>& add_arrays) {
  const vtkSmartPointer<vtkPolyData> rest = polydata_of(surface.points_m, surface.triangles);
  write_surface_series(folder, "surface", instants, [&](std::size_t t) {
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->ShallowCopy(rest);
    add_arrays(t, data);
    return data;
  });
}

}  // namespace

void write_surfaces(const std::filesystem::path& folder, const fast::Run& run, const reference::Result& result,
                    const Errors& errors) {
  write_body(folder, run.surface, run.instants, [&](std::size_t t, vtkPolyData* data) {
    const Eigen::Matrix3Xd& fast_m = run.instants[t].displacement_m;
    const Eigen::Matrix3Xd& reference_m = result.instants[t].displacement_m;
    const Eigen::Matrix3Xd error_m = fast_m - reference_m;
    add_vectors(data, "displacement_fast_m", fast_m);
    add_vectors(data, "displacement_reference_m", reference_m);
    add_vectors(data, "displacement_error_m", error_m);
    add_numbers(data, "displacement_error_magnitude_m", error_m.colwise().norm().transpose());
    add_numbers(data, "displacement_reference_uncertainty_m", result.instants[t].displacement_uncertainty_m);
    add_traction(data, result.instants[t], "traction_reference");
    if (run.instants[t].normal.size() > 0) add_vectors(data, "normal_fast", run.instants[t].normal);
    add_region(data, "region_id_fast", errors.instants[t].touched_fast);
    add_region(data, "region_id_reference", errors.instants[t].touched_reference);
  });
}

void write_tool(const std::filesystem::path& folder, const scene::Tool& tool, const scene::Instants& instants) {
  const scene::Surface own = scene::tool_surface(tool, vtk_tool_triangles);
  write_surface_series(folder, "tool", instants, [&](std::size_t t) {
    const scene::Pose& pose = instants[t].tool;
    return polydata_of((pose.orientation.toRotationMatrix() * own.points_m).colwise() + pose.position_m, own.triangles);
  });
}

void write_fast_surfaces(const std::filesystem::path& folder, const fast::Run& run) {
  write_body(folder, run.surface, run.instants, [&](std::size_t t, vtkPolyData* data) {
    add_vectors(data, "displacement_m", run.instants[t].displacement_m);
    if (run.instants[t].normal.size() > 0) add_vectors(data, "normal", run.instants[t].normal);
  });
}

void write_reference_surfaces(const std::filesystem::path& folder, const scene::Surface& surface,
                              const reference::Result& result) {
  write_body(folder, surface, result.instants, [&](std::size_t t, vtkPolyData* data) {
    add_vectors(data, "displacement_m", result.instants[t].displacement_m);
    add_numbers(data, "displacement_uncertainty_m", result.instants[t].displacement_uncertainty_m);
    add_traction(data, result.instants[t], "traction");
  });
}

void write_volume(const std::filesystem::path& folder, const scene::Instants& instants,
                  const reference::Inside& inside) {
  write_series(folder, "volume", "vtu", instants, [&](std::size_t t) { return inside.volume_file(t); });
}

}  // namespace touchstone::compare
