// The extremes: the number of the tool's samples and of the body's triangles, and slivers among both.
#include "extremes/rig.h"

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

// A tool of one sample, as printed: a point contact with the law's force at its depth, on a face or an edge. Corrected,
// cells are refined where needed, and the force is nearly that of the default number. As printed: A point under the
// mass centre has no lever arm, and its weight is 0 / 0 (E6).
TEST(SampleExtremes, OneSample) {
  scene::Scene scene = extremes::cube(Formulation::published);
  scene.fast.tool_samples = 1;
  Rig rig(scene);
  rig.may = StepStatus::anchors_limited;
  ASSERT_EQ(rig.model.tool.count(), 1);
  const Vec3 sample_m(rig.model.tool.x_T_m[0], rig.model.tool.y_T_m[0], rig.model.tool.z_T_m[0]);
  struct Way {
    Vec3 from, place_m;  // outward normal of a face, and a place on it
  };
  for (const auto& [from, place_m] :
       {Way{Vec3(-1, 0, 0), Vec3(-0.03, 0.002, 0.03)}, Way{Vec3(0, 0, 1), Vec3(0.004, 0.007, 0.06)}}) {
    for (const double depth_m : {-0.001, 0.001, 0.002})
      rig.to({place_m - depth_m * from - sample_m, Eigen::Quaterniond::Identity()});
    ASSERT_EQ(rig.region().points.count, 1);
    EXPECT_LE((rig.force_n() - rig.law().force_n(0.002) * from).norm(), 1e-9 * rig.force_n().norm());
    rig.to(test::at(0.0, 0.0, 1.0));
  }
  std::vector<double> force_n;
  for (const int samples : {1, 2000}) {
    scene = extremes::cube(Formulation::corrected);
    scene.fast.tool_samples = samples;
    Rig cells(scene);
    cells.may = StepStatus::anchors_limited;
    cells.to(test::pressed(0.003, 0.004, 0.007));
    force_n.push_back(cells.force_n().z());
  }
  EXPECT_NEAR(force_n[0], force_n[1], 0.02 * force_n[1]);
}

// 1e5 samples: force and corrected surface converge, closer with every factor of five. As printed: The more samples,
// the shallower the surface beside the contact, by 1 + ln n (E16).
TEST(SampleExtremes, HundredThousandSamplesConverge) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<Vec3> force_n;
    std::vector<double> moved_m;
    for (const int samples : {4000, 20000, 100000}) {
      scene::Scene scene = extremes::cube(formulation);
      scene.fast.tool_samples = samples;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      rig.to(test::pressed(0.003, 0.004, 0.007));
      force_n.push_back(rig.force_n());
      // Beside the contact, within R.
      double sum_m = 0.0;
      for (std::size_t v = 0; v < rig.model.rest.vertex_count(); ++v) sum_m += rig.displacement_m(v).norm();
      moved_m.push_back(sum_m);
    }
    const auto nearer = [](double first, double second, double size) {
      return second <= std::max(0.5 * first, 0.002 * size);
    };
    EXPECT_PRED3(nearer, (force_n[1] - force_n[0]).norm(), (force_n[2] - force_n[1]).norm(), force_n[2].norm());
    if (formulation == Formulation::corrected) {
      EXPECT_PRED3(nearer, std::abs(moved_m[1] - moved_m[0]), std::abs(moved_m[2] - moved_m[1]), moved_m[2]);
    } else {
      EXPECT_LT(moved_m[2], moved_m[1]);
      EXPECT_LT(moved_m[1], moved_m[0]);
    }
  }
}

/// The punch as a mesh. Each face is a fan of triangles about a point at this distance from its first corner, in units
/// of its diagonal; each side is divided into so many pieces.
scene::Scene meshed_punch(Formulation formulation, double apex, int pieces) {
  scene::Scene scene = extremes::cube(formulation);
  const Vec3 half_m(0.005, 0.005, 0.01);
  scene::TriangleMesh mesh;
  std::vector<Vec3> points_m;
  const auto add = [&](const Vec3& p_m) {
    points_m.push_back(p_m);
    return static_cast<std::int32_t>(points_m.size() - 1);
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 out = side * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = out.cross(u);
      const auto at = [&](double s, double t) { return Vec3(half_m.cwiseProduct(out + s * u + t * v)); };
      const std::int32_t middle = add(at(2.0 * apex - 1.0, 2.0 * apex - 1.0));
      std::vector<std::int32_t> rim;
      constexpr std::array<std::array<double, 2>, 5> corners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}};
      for (std::size_t c = 0; c < 4; ++c) {
        for (int k = 0; k < pieces; ++k) {
          const double w = static_cast<double>(k) / pieces;
          rim.push_back(add(at((1.0 - w) * corners[c][0] + w * corners[c + 1][0],
                               (1.0 - w) * corners[c][1] + w * corners[c + 1][1])));
        }
      }
      for (std::size_t k = 0; k < rim.size(); ++k)
        mesh.triangles.push_back({middle, rim[k], rim[(k + 1) % rim.size()]});
    }
  }
  mesh.points_m.resize(3, static_cast<Eigen::Index>(points_m.size()));
  for (std::size_t i = 0; i < points_m.size(); ++i) mesh.points_m.col(static_cast<Eigen::Index>(i)) = points_m[i];
  extremes::use_mesh(std::move(mesh), scene);
  return scene;
}

// A tool's mesh with slivers a million times as long as wide, and with triangles of zero area: the corrected force is
// that of the tool itself. As printed: Contact points are the mesh's vertices, "provided that these vertex points are
// evenly distributed": each has the same weight, whatever its area (E6).
TEST(SampleExtremes, ToolMeshOfSlivers) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const double tilt : {0.0, 0.05}) {
      const scene::Pose pose{Vec3(0.003, 0.002, 0.0685),
                             Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vec3(1, 2, 0).normalized()))};
      Rig regular(meshed_punch(formulation, 0.5, 8));
      regular.may = StepStatus::anchors_limited;
      regular.to(pose);
      ASSERT_GT(regular.force_n().z(), 0.1);
      for (const double apex : {1e-6, 0.0}) {
        for (const int pieces : {1, 50}) {
          Rig slivers(meshed_punch(formulation, apex, pieces));
          slivers.may = StepStatus::anchors_limited;
          slivers.to(pose);
          const double most = formulation == Formulation::corrected ? 0.05 : 0.5;
          EXPECT_LE((slivers.force_n() - regular.force_n()).norm(), most * regular.force_n().norm())
              << apex << " " << pieces << " tilt " << tilt;
        }
      }
    }
  }
}

// A bar 200 times as long as wide with the fewest triangles allowed: normals of length 1, the surface bounded, and
// exactly the force for 20000 triangles. As printed: Contact is found on the body's mesh, so the force depends on its
// triangles.
TEST(SampleExtremes, BodyOfSlivers) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::cube(formulation);
    scene.body.size_m = Vec3(2.0, 0.01, 0.01);
    std::vector<Vec3> force_n;
    for (const int triangles : {12, 20000}) {
      scene.fast.triangles = triangles;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      for (const double z_m : {0.0205, 0.019, 0.017}) rig.to(test::at(0.3, 0.0, z_m));
      EXPECT_GT(rig.force_n().z(), 0.0);
      force_n.push_back(rig.force_n());
    }
    EXPECT_EQ(force_n[0], force_n[1]);
  }
}

// The fewest samples that a tool of each shape may have: a force within the law's bound from every side. As printed: A
// contact without a vertex of the tool has no weights: 0 / 0.
TEST(SampleExtremes, FewestSamplesOfEveryTool) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::ToolShape shape :
         {scene::ToolShape::sphere, scene::ToolShape::capsule, scene::ToolShape::cylinder, scene::ToolShape::box}) {
      scene::Scene scene = extremes::cube(formulation);
      scene.tool.shape = shape;
      scene.tool.length_m = 0.02;
      scene.tool.size_m = Vec3(0.02, 0.02, 0.02);
      scene.fast.tool_samples = 1;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
      double most_n = 0.0;
      for (int i = 0; i <= 60; ++i) {
        const double angle = 0.1 * i;
        rig.to({Vec3(0.0, 0.0, 0.03) + (0.055 - 0.0005 * i) * Vec3(std::cos(angle), 0.0, std::sin(angle)),
                Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * i, Vec3(1, 2, 3).normalized()))});
        most_n = std::max(most_n, rig.force_n().norm());
      }
      EXPECT_GT(most_n, 0.0);
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
