#include "fast/response/finite_strain.h"

namespace touchstone::fast {

FiniteStrain finite_strain(double poissons_ratio) noexcept {
  const double nu = poissons_ratio;
  return {-0.73 + nu * (1.093 + nu * 1.447), 0.355 - nu * (0.423 + nu * 1.033)};
}

}  // namespace touchstone::fast
