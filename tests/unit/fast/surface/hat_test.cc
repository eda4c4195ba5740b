#include "fast/surface/hat.h"

#include "fast/surface/patch_kernels.h"
#include "scene/shape/surface.h"
#include "support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// A body, and kernel functions at the points of its mesh.
struct Hatted {
  explicit Hatted(const test::NamedBody& named)
      : name(named.name),
        shape(scene::body_shape(named.body)),
        anchors(anchor_points(named.body, *shape)),
        surface(scene::tessellate(*shape, 1200)),
        rest(surface_patches(surface, *anchors)) {
    for (std::size_t p = 0; p < rest.patches.size(); ++p) {
      for (std::int32_t v = rest.patches[p].begin; v < rest.patches[p].end; ++v) {
        patch_of.push_back(p);
        const Vec3 key = surface.points_m.col(v) * 1e8;
        at_place[{std::lround(key.x()), std::lround(key.y()), std::lround(key.z())}].push_back(v);
      }
    }
  }
  [[nodiscard]] PatchPlace place(std::int32_t v) const {
    return anchors->at(static_cast<int>(patch_of[static_cast<std::size_t>(v)]), surface.points_m.col(v));
  }
  /// Values at every vertex of the kernel function at one of them.
  [[nodiscard]] std::vector<float> over(std::int32_t top, decltype(hat_part)* part_of = hat_part) const {
    return over(patch_of[static_cast<std::size_t>(top)], place(top), part_of);
  }
  [[nodiscard]] std::vector<float> over(std::size_t from, const PatchPlace& top,
                                        decltype(hat_part)* part_of = hat_part) const {
    std::vector<float> height(rest.vertex_count(), 0.0f);
    for (std::size_t p = 0; p < rest.patches.size(); ++p) {
      const HatPart part = part_of(rest.patches[from], top, rest.patches[p]);
      if (!part.reaches()) continue;
      const Hat hat(rest, part);
      for (std::int32_t v = rest.patches[p].begin; v < rest.patches[p].end; ++v) {
        height[static_cast<std::size_t>(v)] = hat(static_cast<std::size_t>(v));
      }
    }
    return height;
  }

  [[nodiscard]] int moving_patches() const {
    return static_cast<int>(std::count_if(rest.patches.begin(), rest.patches.end(), [&](const Patch& patch) {
      return std::any_of(rest.free.begin() + patch.begin, rest.free.begin() + patch.end, [](float f) { return f > 0; });
    }));
  }

  std::string name;
  std::unique_ptr<const scene::Shape> shape;
  std::unique_ptr<const AnchorPoints> anchors;
  scene::Surface surface;
  SurfacePatches rest;
  std::vector<std::size_t> patch_of;                                  ///< per vertex
  std::map<std::array<long, 3>, std::vector<std::int32_t>> at_place;  ///< vertices at one place
};

class HatOver : public testing::TestWithParam<test::NamedBody> {};
INSTANTIATE_TEST_SUITE_P(Bodies, HatOver, testing::ValuesIn(test::bodies()), [](const auto& named) {
  std::string name = named.param.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
});

TEST_P(HatOver, APointIsOneThereAndZeroOnHeldSurface) {
  const Hatted on(GetParam());
  for (std::int32_t top = 0; top < static_cast<std::int32_t>(on.rest.vertex_count()); top += 37) {
    if (on.place(top).free < 1e-3) continue;
    const std::vector<float> height = on.over(top);
    EXPECT_NEAR(height[static_cast<std::size_t>(top)], 1.0, 1e-6) << on.name;
    double mean = 0.0;
    for (std::size_t v = 0; v < height.size(); ++v) {
      ASSERT_GE(height[v], 0.0f);
      ASSERT_LE(height[v], 1.0f);
      if (on.place(static_cast<std::int32_t>(v)).held()) {
        ASSERT_EQ(height[v], 0.0f) << on.name;
      }
      mean += height[v] / static_cast<double>(height.size());
    }
    EXPECT_LT(mean, 0.5) << on.name;
  }
}

TEST_P(HatOver, ABorderIsTheSameSeenFromEveryPatchThere) {
  const Hatted on(GetParam());
  int compared = 0;
  for (const auto& [key, vertices] : on.at_place) {
    if (vertices.size() < 2 || on.place(vertices[0]).free < 1e-3) continue;
    if (compared++ > 40) break;
    const std::vector<float> first = on.over(vertices[0]);
    for (std::size_t k = 1; k < vertices.size(); ++k) {
      const std::vector<float> other = on.over(vertices[k]);
      for (std::size_t v = 0; v < first.size(); ++v) ASSERT_NEAR(other[v], first[v], 1e-5) << on.name;
    }
  }
  // A single cap on the fixed surface has no border that moves.
  if (on.moving_patches() > 1) {
    EXPECT_GT(compared, 20) << on.name;
  }
}

TEST_P(HatOver, APointHasNoTearOnAnyBorder) {
  const Hatted on(GetParam());
  for (std::int32_t top = 5; top < static_cast<std::int32_t>(on.rest.vertex_count()); top += 41) {
    if (on.place(top).free < 1e-3) continue;
    const std::vector<float> height = on.over(top);
    for (const auto& [key, vertices] : on.at_place) {
      for (const std::int32_t v : vertices) {
        ASSERT_NEAR(height[static_cast<std::size_t>(v)], height[static_cast<std::size_t>(vertices[0])], 1e-5)
            << on.name << " over " << on.surface.points_m.col(top).transpose() << " at "
            << on.surface.points_m.col(v).transpose();
      }
    }
  }
}

test::NamedBody body_named(const std::string& name) {
  for (const test::NamedBody& named : test::bodies()) {
    if (named.name == name) return named;
  }
  ADD_FAILURE() << "no body " << name;
  return test::bodies().front();
}

std::int32_t vertex_near(const Hatted& on, const Vec3& p_m) {
  Eigen::Index v = 0;
  (on.surface.points_m.colwise() - p_m).colwise().squaredNorm().minCoeff(&v);
  return static_cast<std::int32_t>(v);
}

TEST(Hat, OverATriangleIsLinearOnThreeTriangles) {
  const Hatted on(body_named("sphere"));
  const std::int32_t top = vertex_near(on, on.shape->at(0, 0.4, 0.6).point_m);
  const std::array<double, 4> c = on.place(top).weight;
  const Patch& patch = on.rest.patches[on.patch_of[static_cast<std::size_t>(top)]];
  ASSERT_GT(*std::min_element(c.begin(), c.begin() + 3), hat_weight);
  const std::vector<float> height = on.over(top);
  for (std::int32_t v = patch.begin; v < patch.end; ++v) {
    const std::array<double, 4> w = on.place(v).weight;
    EXPECT_NEAR(height[static_cast<std::size_t>(v)], std::min({w[0] / c[0], w[1] / c[1], w[2] / c[2]}), 1e-6);
  }
  for (std::size_t v = 0; v < height.size(); ++v) {
    if (on.patch_of[v] != on.patch_of[static_cast<std::size_t>(top)]) {
      EXPECT_EQ(height[v], 0.0f);
    }
  }
}

TEST(Hat, OverAPoleSpreadsOverAllItsPatchesAlike) {
  const Hatted on(body_named("sphere"));
  const double radius_m = on.shape->bounds().upper_m.x();
  const Vec3 pole(0.0, 0.0, 2.0 * radius_m);
  const std::vector<float> height = on.over(vertex_near(on, pole));
  std::array<double, 4> sum{};
  for (std::size_t v = 0; v < height.size(); ++v) {
    if (on.patch_of[v] < 4) {
      sum[on.patch_of[v]] += height[v];
    } else {
      EXPECT_EQ(height[v], 0.0f);
    }
  }
  for (const double one : sum) {
    EXPECT_GT(one, 1.0);
    EXPECT_NEAR(one, sum[0], 1e-3 * sum[0]);
  }
}

TEST(Hat, ChangesLittleWhenItsPointComesToAnEdgeOrAnAnchorPoint) {
  for (const auto& body : {std::pair("box", 5), std::pair("sphere", 0)}) {
    // clang 14 cannot capture a structured binding in a lambda.
    const int patch = body.second;
    const Hatted on(body_named(body.first));
    // Towards an edge and towards a corner of the patch.
    for (const auto& place : {std::pair(0.0, 0.4), std::pair(0.0, 0.0)}) {
      const double u = place.first, v = place.second;
      const auto over = [&](double off) {
        const Vec3 p_m = on.shape->at(patch, u + off, v + (v == 0.0 ? off : 0.0)).point_m;
        return on.over(static_cast<std::size_t>(patch), on.anchors->at(patch, p_m));
      };
      const std::vector<float> there = over(0.0), near = over(0.002);
      for (std::size_t k = 0; k < there.size(); ++k) EXPECT_NEAR(near[k], there[k], 0.05) << body.first;
    }
  }
}

TEST(Hat, ToCreasesEndsAtABoxEdgeAndNotAtASpheresOctant) {
  const Hatted box(body_named("box"));
  const double top_m = box.shape->bounds().upper_m.z(), side_m = box.shape->bounds().upper_m.x();
  std::int32_t edge = -1;
  for (const std::int32_t v : box.at_place.at({std::lround(side_m * 1e8), 0, std::lround(top_m * 1e8)})) {
    if (box.patch_of[static_cast<std::size_t>(v)] == 5) edge = v;
  }
  ASSERT_GE(edge, 0);
  const std::vector<float> whole = box.over(edge), ended = box.over(edge, hat_part_to_creases);
  double on_the_side = 0.0;
  for (std::size_t v = 0; v < whole.size(); ++v) {
    EXPECT_EQ(ended[v], box.patch_of[v] == 5 ? whole[v] : 0.0f);
    if (box.patch_of[v] == 1) on_the_side += whole[v];
  }
  EXPECT_GT(on_the_side, 1.0);
  const Hatted ball(body_named("sphere"));
  const std::int32_t pole = vertex_near(ball, Vec3(0.0, 0.0, ball.shape->bounds().upper_m.z()));
  EXPECT_EQ(ball.over(pole, hat_part_to_creases), ball.over(pole));
}

}  // namespace
}  // namespace touchstone::fast
