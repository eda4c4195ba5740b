#include "fast/response/finite_strain.h"

namespace touchstone::fast {

FiniteStrain finite_strain(double) noexcept { return {}; }

}  // namespace touchstone::fast
