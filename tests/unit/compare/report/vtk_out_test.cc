#include "compare/report/vtk_out.h"

#include "compare/errors/compute_errors.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <fstream>
#include <sstream>

namespace touchstone::compare {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

class VtkOut : public ::testing::Test {
 protected:
  VtkOut() {
    errors_ = compute_errors(sides_.scene, sides_.run, sides_.result.instants);
    write_surfaces(folder_.path(), sides_.run, sides_.result, errors_);
  }
  vtkPolyData* load(const std::string& name) {
    reader_->SetFileName((folder_.path() / name).c_str());
    reader_->Modified();  // the file may be a new one of the same name
    reader_->Update();
    return reader_->GetOutput();
  }

  testing::Sides sides_ = testing::pressed(3, 200);
  Errors errors_;
  testing::TemporaryFolder folder_;
  vtkNew<vtkXMLPolyDataReader> reader_;
};

TEST_F(VtkOut, ReadsBackToTheSameValues) {
  for (std::size_t t = 0; t < 3; ++t) {
    vtkPolyData* data = load("surface_000" + std::to_string(t) + ".vtp");
    const scene::Surface& surface = sides_.run.surface;
    ASSERT_EQ(data->GetNumberOfPoints(), surface.vertex_count());
    ASSERT_EQ(data->GetNumberOfCells(), surface.triangle_count());
    for (vtkIdType c = 0; c < data->GetNumberOfCells(); ++c) {
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(data->GetCell(c)->GetPointId(k),
                  surface.triangles[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)]);
      }
    }
    const auto vector = [&](const char* name, vtkIdType i) {
      vtkDataArray* array = data->GetPointData()->GetArray(name);
      EXPECT_NE(array, nullptr) << name;
      double v[3] = {};
      array->GetTuple(i, v);
      return scene::Vec3(v[0], v[1], v[2]);
    };
    const auto number = [&](const char* name, vtkIdType i) {
      return data->GetPointData()->GetArray(name)->GetTuple1(i);
    };
    const Eigen::Matrix3Xd& fast_m = sides_.run.instants[t].displacement_m;
    const Eigen::Matrix3Xd& reference_m = sides_.result.instants[t].displacement_m;
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      ASSERT_EQ(scene::Vec3(data->GetPoint(i)), scene::Vec3(surface.points_m.col(i)));
      ASSERT_EQ(vector("displacement_fast_m", i), scene::Vec3(fast_m.col(i)));
      ASSERT_EQ(vector("displacement_reference_m", i), scene::Vec3(reference_m.col(i)));
      ASSERT_EQ(vector("displacement_error_m", i), scene::Vec3(fast_m.col(i) - reference_m.col(i)));
      ASSERT_EQ(number("displacement_error_magnitude_m", i), (fast_m.col(i) - reference_m.col(i)).norm());
      ASSERT_EQ(number("displacement_reference_uncertainty_m", i),
                sides_.result.instants[t].displacement_uncertainty_m[i]);
      ASSERT_EQ(vector("normal_fast", i), scene::Vec3(sides_.run.instants[t].normal.col(i)));
      ASSERT_EQ(number("region_id_fast", i), errors_.instants[t].touched_fast[at] ? 0 : -1);
      ASSERT_EQ(number("region_id_reference", i), errors_.instants[t].touched_reference[at] ? 0 : -1);
    }
  }
}

TEST_F(VtkOut, IsBinaryAndCompressed) {
  const std::string text = read(folder_.path() / "surface_0001.vtp");
  EXPECT_NE(text.find("vtkZLibDataCompressor"), std::string::npos);
  EXPECT_EQ(text.find("format=\"ascii\""), std::string::npos);
}

TEST_F(VtkOut, CollectionGivesEachFileItsTime) {
  const std::string text = read(folder_.path() / "surface.pvd");
  EXPECT_TRUE(testing::is_well_formed(text));
  EXPECT_NE(text.find("timestep=\"0\" part=\"0\" file=\"surface_0000.vtp\""), std::string::npos);
  EXPECT_NE(text.find("timestep=\"0.55000000000000004\" part=\"0\" file=\"surface_0001.vtp\""), std::string::npos);
  EXPECT_NE(text.find("file=\"surface_0002.vtp\""), std::string::npos);
}

TEST_F(VtkOut, LeavesNoSurfaceOfAnEarlierLongerRun) {
  testing::Sides shorter = testing::pressed(2, 200);
  write_surfaces(folder_.path(), shorter.run, shorter.result,
                 compute_errors(shorter.scene, shorter.run, shorter.result.instants));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "surface_0001.vtp"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "surface_0002.vtp"));
}

TEST_F(VtkOut, ToolStandsWhereThePoseSays) {
  const scene::Pose turned{scene::Vec3(0.01, -0.02, 0.08),
                           Eigen::Quaterniond(Eigen::AngleAxisd(0.4, scene::Vec3(1, 2, 3).normalized()))};
  sides_.run.instants[1].tool = turned;
  write_tool(folder_.path(), sides_.scene.tool, sides_.run.instants);
  vtkPolyData* ball = load("tool_0001.vtp");
  ASSERT_GT(ball->GetNumberOfCells(), 1000);
  for (vtkIdType i = 0; i < ball->GetNumberOfPoints(); ++i) {
    ASSERT_NEAR((scene::Vec3(ball->GetPoint(i)) - turned.position_m).norm(), sides_.scene.tool.radius_m, 1e-12);
  }
  const testing::Sides mallet = testing::pressed_by_mallet(folder_.path() / "inputs");
  sides_.run.instants.pop_back();
  write_tool(folder_.path(), mallet.scene.tool, sides_.run.instants);
  vtkPolyData* placed = load("tool_0001.vtp");
  const scene::TriangleMesh own = scene::tool_mesh(mallet.scene.tool);
  ASSERT_EQ(placed->GetNumberOfCells(), static_cast<vtkIdType>(own.triangles.size()));
  for (vtkIdType c = 0; c < placed->GetNumberOfCells(); ++c) {
    for (int k = 0; k < 3; ++k) {
      const auto corner = own.triangles[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)];
      const scene::Vec3 expected = turned.orientation * own.points_m.col(corner) + turned.position_m;
      ASSERT_LT((scene::Vec3(placed->GetPoint(placed->GetCell(c)->GetPointId(k))) - expected).norm(), 1e-12);
    }
  }
  const std::string collection = read(folder_.path() / "tool.pvd");
  EXPECT_TRUE(testing::is_well_formed(collection));
  EXPECT_NE(collection.find("timestep=\"0.55000000000000004\" part=\"0\" file=\"tool_0001.vtp\""), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "tool_0002.vtp")) << "of the longer run before";
}

TEST_F(VtkOut, OneSideAloneHasItsOwnArrays) {
  const testing::TemporaryFolder fast, reference;
  write_fast_surfaces(fast.path(), sides_.run);
  write_reference_surfaces(reference.path(), sides_.run.surface, sides_.result);
  const auto last = [&](const testing::TemporaryFolder& folder) {
    reader_->SetFileName((folder.path() / "surface_0002.vtp").c_str());
    reader_->Update();
    return reader_->GetOutput()->GetPointData();
  };
  const Eigen::Index i = sides_.run.surface.vertex_count() / 2;
  EXPECT_EQ(last(fast)->GetArray("displacement_m")->GetComponent(i, 2), sides_.run.instants[2].displacement_m(2, i));
  EXPECT_EQ(last(fast)->GetArray("normal")->GetComponent(i, 1), sides_.run.instants[2].normal(1, i));
  EXPECT_EQ(last(reference)->GetArray("displacement_m")->GetComponent(i, 2),
            sides_.result.instants[2].displacement_m(2, i));
  EXPECT_EQ(last(reference)->GetArray("displacement_uncertainty_m")->GetComponent(i, 0),
            sides_.result.instants[2].displacement_uncertainty_m[i]);
}

}  // namespace
}  // namespace touchstone::compare
