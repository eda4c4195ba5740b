// Inflation of a thick incompressible neo-Hookean sphere: the displacement is known exactly, so its order can be
// asserted.
#include "reference/verification/problem.h"
#include "reference/verification/solids.h"

#include <gtest/gtest.h>

namespace touchstone::verification {
namespace {

// Quadratic displacement with linear discontinuous pressure: the L2 error of the displacement falls like h^3 (Boffi,
// Brezzi, Fortin, Mixed Finite Element Methods, 8.6.3, with the usual duality argument).
TEST(ThickSphere, DisplacementConvergesWithOrderThree) {
  const InflatedSphere coarse = inflate_sphere(1.25, 4), middle = inflate_sphere(1.25, 8),
                       fine = inflate_sphere(1.25, 16);
  EXPECT_NEAR(observed_order(coarse.displacement_error_l2, middle.displacement_error_l2).value(), 3.0, 0.3);
  EXPECT_NEAR(observed_order(middle.displacement_error_l2, fine.displacement_error_l2).value(), 3.0, 0.3);
  EXPECT_LT(fine.displacement_error_l2, 1e-4);
  EXPECT_NEAR(fine.inner_pressure_pa / fine.exact_pressure_pa, 1.0, 1e-3);
}

}  // namespace
}  // namespace touchstone::verification
