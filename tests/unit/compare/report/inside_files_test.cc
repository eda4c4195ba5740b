// The inside of the body as files: the volume change of the cells in volume.pvd is that of the summary.
#include "compare/report/inside_files.h"

#include "compare/report/stress_section.h"
#include "reference/discretisation/shape.h"
#include "reference/solver.h"
#include "scene/base/files.h"
#include "scene/shape/surface.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <Eigen/LU>
#include <algorithm>
#include <numbers>
#include <stdexcept>

namespace touchstone::compare {
namespace {

class InsideFiles : public ::testing::Test {
 protected:
  InsideFiles() {
    scene_.tool.radius_m = 0.01;
    scene_.body.material = {3e6, 0.4};
    scene_.track = {{0.0, {{0.0, 0.0, 0.0505}, Eigen::Quaterniond::Identity()}},
                    {1.0, {{0.0, 0.0, 0.0480}, Eigen::Quaterniond::Identity()}}};
    scene_.compare.instants = 3;
    scene_.reference.levels = 1;
  }
  reference::Result solve() {
    surface_ = scene::tessellate(*scene::body_shape(scene_.body), 64);
    return reference::solve(scene_, surface_.points_m, {store_.path(), {}, nullptr});
  }

  /// Of the last instant's file, over the volume of its cells: Gauss's rule on the cells that its points are the nodes
  /// of. @tparam dim  2: the meridian plane, turned about the axis
  template <int dim>
  [[nodiscard]] double volume_change_rel() const {
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName((folder_.path() / "volume_0002.vtu").c_str());
    reader->Update();
    vtkUnstructuredGrid* grid = reader->GetOutput();
    vtkDataArray* J_minus_1 = grid->GetPointData()->GetArray("J_minus_1");
    if (J_minus_1 == nullptr) throw std::runtime_error("no J_minus_1");
    constexpr int count = reference::Shape<dim>::size;
    EXPECT_EQ(grid->GetNumberOfPoints() % count, 0);
    double volume = 0.0, change = 0.0;
    for (vtkIdType first = 0; first < grid->GetNumberOfPoints(); first += count) {
      Eigen::Matrix<double, dim, count> X_m;
      Eigen::Matrix<double, 1, count> values;
      for (int a = 0; a < count; ++a) {
        X_m.col(a) = scene::Vec3(grid->GetPoint(first + a)).head<dim>();
        values[a] = J_minus_1->GetTuple1(first + a);
      }
      for (const reference::GaussPoint<dim>& point : reference::gauss_points<dim>()) {
        double weight = point.weight * (X_m * point.shape.gradient).determinant();
        if (dim == 2) weight *= 2.0 * std::numbers::pi * X_m.row(0).dot(point.shape.value);
        volume += weight;
        change += weight * values.dot(point.shape.value);
      }
    }
    return change / volume;
  }

  scene::Scene scene_;
  scene::Surface surface_;
  testing::TemporaryFolder store_, folder_;
};

TEST_F(InsideFiles, TheVolumeChangeOfTheMeridianIsTheSummarys) {
  scene_.body.shape = scene::BodyShape::revolution;
  scene_.body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}}, {}};
  const reference::Result result = solve();
  const double exact = result.instants.back().volume_change_rel;
  ASSERT_LT(exact, -1e-5);
  write_inside(folder_.path(), scene_, result, *reference::inside(scene_, result, store_.path()), true);
  EXPECT_NEAR(volume_change_rel<2>(), exact, 1e-6 * std::abs(exact));
}

TEST_F(InsideFiles, TheVolumeChangeOfAQuarterIsTheSummarysAndOldFilesGo) {
  scene_.body.shape = scene::BodyShape::box;
  scene_.body.size_m = {0.06, 0.05, 0.04};
  scene_.reference.element_size_m = 0.006;
  const reference::Result result = solve();
  ASSERT_NE(result.model.find("quarter"), std::string::npos);
  const double exact = result.instants.back().volume_change_rel;
  const auto inside = reference::inside(scene_, result, store_.path());
  const std::string told = write_inside(folder_.path(), scene_, result, *inside, true);
  EXPECT_NE(told.find("what is solved: quarter"), std::string::npos) << told;
  EXPECT_NEAR(volume_change_rel<3>(), exact, 1e-6 * std::abs(exact));
  const std::string pvd = scene::read_file(folder_.path() / "volume.pvd").value();
  EXPECT_TRUE(testing::is_well_formed(pvd));
  EXPECT_NE(pvd.find("timestep=\"0.5\" part=\"0\" file=\"volume_0001.vtu\""), std::string::npos) << pvd;
  EXPECT_EQ(write_inside(folder_.path(), scene_, result, *inside, false), "");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "volume_0000.vtu"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "volume.pvd"));

  // Probes: a row per instant and probe, the values of the last row those of the solution.
  scene_.probes = {{"top", {0.0, 0.0, 0.04}}, {"left of it", {-0.004, 0.0, 0.03}}};
  write_inside(folder_.path(), scene_, result, *inside, false);
  const std::string csv = scene::read_file(folder_.path() / "probes.csv").value();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 2);
  EXPECT_NE(csv.find("\n1.0,left of it,-0.004,0.0,0.03,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",nan\n"), std::string::npos) << "one mesh has no uncertainty";
  // The section's points are all in the body, which answers at each of them.
  const SectionGrid grid = section_grid(surface_, result.instants.back().tool);
  const reference::PointValues values = inside->at(grid.rest_m, 2);
  EXPECT_TRUE(values.stress_pa.allFinite());
  const std::string svg = stress_section_svg(scene_, surface_, result.instants.back(), grid, values);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  scene_.probes.clear();
  write_inside(folder_.path(), scene_, result, *inside, false);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "probes.csv"));
}

TEST(StressSection, NamesThePlaceOfTheLargestStress) {
  const testing::Sides sides = testing::pressed(3, 600);
  const scene::InstantRecord& record = sides.result.instants.back();
  const SectionGrid grid = section_grid(sides.run.surface, record.tool);
  reference::PointValues values{Eigen::Matrix3Xd::Zero(3, grid.rest_m.cols()),
                                Eigen::Matrix<double, 9, Eigen::Dynamic>::Zero(9, grid.rest_m.cols())};
  const auto body = scene::body_shape(sides.scene.body);
  for (const auto& point_m : grid.rest_m.colwise()) ASSERT_LT(body->signed_distance_m(point_m), 1e-9);
  const Eigen::Index at = 48 * grid.rows;  // the lowest of the middle column
  values.stress_pa(8, at) = -5e4;
  const std::string caption = stress_section_caption(grid, values);
  EXPECT_NE(caption.find("Largest: 50 kPa at x = 0"), std::string::npos) << caption;
  const std::string svg = stress_section_svg(sides.scene, sides.run.surface, record, grid, values);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  EXPECT_LT(svg.size(), 400'000u);
}

}  // namespace
}  // namespace touchstone::compare
