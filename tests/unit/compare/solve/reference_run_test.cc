#include "compare/solve/reference_run.h"

#include "support/synthetic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReferenceText, BelowThreeMeshesTheUncertaintyIsUnknown) {
  testing::Sides sides = testing::pressed(3, 200);
  reference::Result& result = sides.result;
  EXPECT_THAT(reference_text(result), HasSubstr(" N, +- "));
  for (const double unknown : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    result.levels.resize(2);
    testing::set_all(result, &scene::ReferenceInstant::force_uncertainty_n, unknown);
    result.force_uncertainty_rel = result.shape_uncertainty_rel = unknown;
    const std::string text = reference_text(result);
    EXPECT_THAT(text, HasSubstr(" N, uncertainty unknown\n"));
    EXPECT_THAT(text, HasSubstr("Uncertainty of the reference: force unknown, shape unknown, from 2 meshes"));
    EXPECT_THAT(text, Not(HasSubstr("inf")));
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_FALSE(known_to(result, 0.5));
  }
}

}  // namespace
}  // namespace touchstone::compare
