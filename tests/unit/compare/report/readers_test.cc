// The files of the commands, read by VTK's own readers, as ParaView does: with a known uncertainty and without one.
#include "compare/comparison/compare.h"
#include "compare/report/vtk_out.h"
#include "compare/solve/reference_run.h"
#include "fast/command/results.h"
#include "scene/output/results.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkDelimitedTextReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUtilities.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>

namespace touchstone::compare {
namespace {

using std::filesystem::path;

/// Columns of a CSV file by their names. A column that VTK reads as text fails the test.
std::map<std::string, std::vector<double>> read_csv(const path& file) {
  vtkNew<vtkDelimitedTextReader> reader;
  reader->SetFileName(file.c_str());
  reader->SetHaveHeaders(true);
  reader->DetectNumericColumnsOn();
  reader->Update();
  std::map<std::string, std::vector<double>> columns;
  vtkTable* table = reader->GetOutput();
  for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c) {
    auto* column = vtkDataArray::SafeDownCast(table->GetColumn(c));
    if (column == nullptr) {
      ADD_FAILURE() << file << ": " << table->GetColumnName(c) << " is text to VTK";
      continue;
    }
    std::vector<double>& values = columns[table->GetColumnName(c)];
    for (vtkIdType row = 0; row < column->GetNumberOfTuples(); ++row) values.push_back(column->GetComponent(row, 0));
  }
  return columns;
}

/// The surfaces of a collection, each as VTK reads it, by their times.
std::map<double, vtkSmartPointer<vtkPolyData>> read_series(const path& collection) {
  std::map<double, vtkSmartPointer<vtkPolyData>> series;
  vtkSmartPointer<vtkXMLDataElement> root;
  root.TakeReference(vtkXMLUtilities::ReadElementFromFile(collection.c_str()));
  vtkXMLDataElement* rows = root != nullptr ? root->FindNestedElementWithName("Collection") : nullptr;
  for (int i = 0; rows != nullptr && i < rows->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* row = rows->GetNestedElement(i);
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((collection.parent_path() / row->GetAttribute("file")).c_str());
    reader->Update();
    EXPECT_EQ(reader->GetErrorCode(), 0u);
    double time_s = std::nan("");
    EXPECT_EQ(row->GetScalarAttribute("timestep", time_s), 1);
    series[time_s] = reader->GetOutput();
  }
  return series;
}

class Readers : public ::testing::TestWithParam<bool> {
 protected:
  Readers() {
    if (GetParam()) return;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    testing::set_all(sides_.result, &scene::ReferenceInstant::force_uncertainty_n, unknown);
    for (scene::ReferenceInstant& instant : sides_.result.instants)
      instant.displacement_uncertainty_m.setConstant(unknown);
    sides_.result.force_uncertainty_rel = sides_.result.shape_uncertainty_rel = unknown;
  }
  /// Checks that a value is a number if it is known by the test's parameter, else NaN.
  static void expect_known(double value) {
    EXPECT_TRUE(GetParam() ? std::isfinite(value) : std::isnan(value)) << value;
  }

  testing::Sides sides_ = testing::pressed(4, 200);
  testing::TemporaryFolder folder_;
};

TEST_P(Readers, OfAComparison) {
  (void)write_comparison(folder_.path(), sides_.scene, sides_.run, sides_.result, sides_.manifest, {});
  const auto columns = read_csv(folder_.path() / "curve.csv");
  EXPECT_EQ(columns.at("fast_force_n").size(), 4u);
  EXPECT_EQ(columns.at("fast_force_n")[3], sides_.run.instants[3].force_n().norm());
  expect_known(columns.at("reference_force_uncertainty_n")[3]);
  expect_known(columns.at("reference_shape_uncertainty_rel_l2")[3]);
  EXPECT_TRUE(std::isnan(columns.at("error_force_rel")[0])) << "no contact: no reference value for the error";
  const auto surfaces = read_series(folder_.path() / "surface.pvd");
  ASSERT_EQ(surfaces.size(), 4u);
  vtkPolyData* last = surfaces.rbegin()->second;
  EXPECT_EQ(surfaces.rbegin()->first, sides_.run.instants[3].time_s);
  ASSERT_EQ(last->GetNumberOfPoints(), sides_.run.surface.vertex_count());
  for (vtkIdType i = 0; i < last->GetNumberOfPoints(); ++i) {
    expect_known(last->GetPointData()->GetArray("displacement_reference_uncertainty_m")->GetComponent(i, 0));
    EXPECT_TRUE(std::isfinite(last->GetPointData()->GetArray("displacement_error_magnitude_m")->GetComponent(i, 0)));
  }
  const auto tools = read_series(folder_.path() / "tool.pvd");
  ASSERT_EQ(tools.size(), 4u);
  for (const auto& [time_s, surface] : surfaces) ASSERT_TRUE(tools.contains(time_s)) << "one clock for both";
  EXPECT_GT(tools.rbegin()->second->GetNumberOfCells(), 1000);
}

TEST_P(Readers, OfAReferenceAlone) {
  write_reference(folder_.path(), sides_.result, sides_.manifest);
  write_reference_surfaces(folder_.path(), sides_.run.surface, sides_.result);
  expect_known(read_csv(folder_.path() / "curve.csv").at("force_uncertainty_n")[3]);
  const auto surfaces = read_series(folder_.path() / "surface.pvd");
  ASSERT_EQ(surfaces.size(), 4u);
  expect_known(surfaces.rbegin()->second->GetPointData()->GetArray("displacement_uncertainty_m")->GetComponent(0, 0));
}

INSTANTIATE_TEST_SUITE_P(Uncertainty, Readers, ::testing::Bool(),
                         [](const auto& of) { return of.param ? std::string("Known") : std::string("Unknown"); });

TEST(ReadersOfOneSide, OfAFastRun) {
  const testing::TemporaryFolder folder;
  scene::Scene scene = testing::ball_on_cube(3, 200);
  scene.fast.rate_hz = 100.0;
  const fast::Run run = fast::run_into_folder(scene, folder.path(), scene::make_manifest(scene, "test"), true);
  write_fast_surfaces(folder.path(), run);
  EXPECT_EQ(read_csv(folder.path() / "curve.csv").at("region0_force_z_n").size(), 3u);
  EXPECT_EQ(read_csv(folder.path() / "beams.csv").empty(), false);
  EXPECT_EQ(read_series(folder.path() / "surface.pvd").size(), 3u);
}

}  // namespace
}  // namespace touchstone::compare
