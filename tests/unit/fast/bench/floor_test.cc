#include "fast/bench/floor.h"

#include "fast/bench/workload.h"
#include "fast/step/model.h"

#include <gtest/gtest.h>

namespace touchstone::bench {
namespace {

TEST(CopyFloor, CopiesAllSixColumnsOfEveryVertex) {
  const fast::FastModel model(scene_of({scene::BodyShape::box, "1k", 1}));
  CopyFloor floor{fast::SurfaceField(model.rest)};
  EXPECT_NE(floor.to().displacement_m, floor.from().displacement_m);
  EXPECT_NE(floor.to().normal, floor.from().normal);
  floor.copy();
  EXPECT_EQ(floor.to().displacement_m, floor.from().displacement_m);
  EXPECT_EQ(floor.to().normal, floor.from().normal);
  EXPECT_EQ(floor.to().memory_bytes(), model.rest.vertex_count() * 24u) << "what a step writes";
}

}  // namespace
}  // namespace touchstone::bench
