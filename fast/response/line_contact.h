// Contact of a capsule on its side with a linear half space, which has no closed form.
#pragma once

#include <vector>

namespace touchstone::fast {

/// Cells over a quarter of the overlap of the surfaces at rest, which holds the contact.
inline constexpr int line_cells_across = 16, line_cells_along = 32;

/// A contact at one indentation.
struct LineContact {
  double force_n = 0.0;
  double half_width_m = 0.0;                 ///< of the contact in its middle
  double across2_m2 = 0.0, along2_m2 = 0.0;  ///< mean squares of the distance from the middle, weighted by pressure
  std::vector<float> pressure_rel;           ///< on the cells, along is the fastest, over the mean of all cells
};

/// A ball of radius_m, swept along a line of length 2 half_line_m, pressed without friction into a half space by
/// indentation_m, which is at most radius_m. Pressures are constant on cells (A. E. H. Love, Phil. Trans. R. Soc. A 228
/// (1929) 377-420) and never negative, by the method of I. A. Polonsky & L. M. Keer (Wear 231 (1999) 206-219). One
/// quarter is solved for, by symmetry. A contact takes about 30 ms.
/// @param E_star_pa  E / (1 - nu^2)
[[nodiscard]] LineContact line_contact(double radius_m, double half_line_m, double indentation_m, double E_star_pa);

}  // namespace touchstone::fast
