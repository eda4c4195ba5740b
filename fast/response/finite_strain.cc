#include "fast/response/finite_strain.h"

namespace touchstone::fast {

FiniteStrain finite_strain(double poissons_ratio) noexcept {
  const double nu = poissons_ratio;
  return {.c1 = -0.73 + nu * (1.093 + nu * 1.447),
          .c2 = 0.355 - nu * (0.423 + nu * 1.033),
          .k1 = -0.14 + nu * (0.295 + nu * 0.35),
          .p1 = 1.45 + nu * (-2.853 - nu * 1.933),
          .p2 = -1.72 + nu * (1.857 + nu * 2.367)};
}

}  // namespace touchstone::fast
