#include "fast/surface/normals.h"

#include "fast/step/model.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

Vec3 vector_at(const Columns3& columns, int v) {
  const auto k = static_cast<std::size_t>(v);
  return Vec3(columns[0][k], columns[1][k], columns[2][k]);
}

template <class Field>
void displace(const FastModel& model, SurfaceField& field, const Field& u) {
  for (int v = 0; v < model.surface.vertex_count(); ++v) {
    const Vec3 here = u(Vec3(model.surface.points_m.col(v)));
    for (int axis = 0; axis < 3; ++axis) {
      field.displacement_m[static_cast<std::size_t>(axis)][static_cast<std::size_t>(v)] =
          static_cast<float>(here[axis]);
    }
  }
}

TEST(Normals, OfTheUndeformedBodyAreTheShapes) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    const FastModel model(scene);
    SurfaceField field(model.rest);
    for (auto& column : field.normal) column.assign(column.size(), 0.0f);
    update_normals(model.normals, field);
    for (int v = 0; v < model.surface.vertex_count(); ++v) {
      EXPECT_LT((vector_at(field.normal, v) - Vec3(model.surface.normals.col(v))).norm(), 1e-6);
    }
  }
}

TEST(Normals, TurnWithALinearDeformation) {
  // x' = A x has normals along A^-T n exactly, on flat and on curved surfaces.
  scene::Mat3 A;
  A << 1.1, 0.05, -0.2, 0.1, 0.9, 0.15, 0.02, -0.1, 0.8;
  for (const auto& [scene, tolerance] : {std::pair{test::ball_on_cube(), 1e-4}, {test::ball_on_sphere(), 5e-3}}) {
    const FastModel model(scene);
    SurfaceField field(model.rest);
    displace(model, field, [&](const Vec3& p) { return Vec3(A * p - p); });
    update_normals(model.normals, field);
    for (int v = 0; v < model.surface.vertex_count(); ++v) {
      const Vec3 expected = (A.inverse().transpose() * Vec3(model.surface.normals.col(v))).normalized();
      EXPECT_LT((vector_at(field.normal, v) - expected).norm(), tolerance * 20.0) << v;
      EXPECT_NEAR(vector_at(field.normal, v).norm(), 1.0, 1e-6);
    }
  }
}

TEST(Normals, ConvergeToTheSmoothSurfacesAtSecondOrder) {
  // A smooth wave on the top face.
  const double amplitude = 0.002, wave = 2.0 * std::numbers::pi / 0.03;
  const auto error = [&](int triangles) {
    scene::Scene scene = test::ball_on_cube();
    scene.fast.triangles = triangles;
    const FastModel model(scene);
    SurfaceField field(model.rest);
    displace(model, field,
             [&](const Vec3& p) { return Vec3(0.0, 0.0, p.z() > 0.0599 ? amplitude * std::sin(wave * p.x()) : 0.0); });
    update_normals(model.normals, field);
    double worst = 0.0;
    const Patch& top = model.rest.patches[5];
    for (int v = top.begin; v < top.end; ++v) {
      const Vec3 p = model.surface.points_m.col(v);
      if (std::abs(p.x()) > 0.029 || std::abs(p.y()) > 0.029) continue;
      const Vec3 expected = Vec3(-amplitude * wave * std::cos(wave * p.x()), 0.0, 1.0).normalized();
      worst = std::max(worst, (vector_at(field.normal, v) - expected).norm());
    }
    return worst;
  };
  const double coarse = error(12 * 20 * 20), fine = error(12 * 40 * 40);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.15);
}

TEST(Normals, KeepTheRestNormalWhereTheSurfaceIsCrushed) {
  const FastModel model(test::ball_on_cube());
  SurfaceField field(model.rest);
  displace(model, field, [](const Vec3& p) { return Vec3(-p); });
  update_normals(model.normals, field);
  for (int v = 0; v < model.surface.vertex_count(); ++v) {
    // Single precision keeps only part of the surface's geometry.
    EXPECT_GT(vector_at(field.normal, v).dot(Vec3(model.surface.normals.col(v))), 0.9);
    EXPECT_NEAR(vector_at(field.normal, v).norm(), 1.0, 1e-6);
  }
}

TEST(Normals, StencilsStayInTheirPatchAndCoverEveryVertex) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    const FastModel model(scene);
    std::vector<int> times(static_cast<std::size_t>(model.surface.vertex_count()), 0);
    for (const NormalStencils::Run& run : model.normals.runs) {
      for (int v = run.begin; v < run.end; ++v) ++times[static_cast<std::size_t>(v)];
      for (const Patch& patch : model.rest.patches) {
        if (run.begin < patch.begin || run.begin >= patch.end) continue;
        for (const int offset : run.offset) {
          EXPECT_GE(run.begin + offset, patch.begin);
          EXPECT_LE(run.end - 1 + offset, patch.end - 1);
        }
      }
    }
    for (const int count : times) EXPECT_LE(count, 1);
    for (const NormalStencils::Single& single : model.normals.singles) {
      ++times[static_cast<std::size_t>(single.vertex)];
      for (const Patch& patch : model.rest.patches) {
        if (single.vertex < patch.begin || single.vertex >= patch.end) continue;
        for (const int to : single.neighbour) {
          EXPECT_GE(to, patch.begin);
          EXPECT_LT(to, patch.end);
        }
      }
    }
    for (const int count : times) EXPECT_GE(count, 1);
    // Most vertices must be in runs, or the pass is slow.
    EXPECT_LT(model.normals.singles.size(), times.size() / 3);
  }
}

}  // namespace
}  // namespace touchstone::fast
