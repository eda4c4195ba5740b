#include "fast/beam.h"

#include <numbers>

namespace touchstone::fast {

double second_moment_m4(double area_m2) noexcept { return area_m2 * area_m2 / (4.0 * std::numbers::pi); }

double bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double left_m = 0.0;  // l - x at the segment's far end
  double sum = 0.0;
  // From the loaded end, so that l - x grows and nothing cancels: the integral of t^2 from b to b + c is
  // c (b^2 + b c + c^2 / 3).
  for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
    const double b = left_m, c = segment->length_m;
    sum += c * (b * b + b * c + c * c / 3.0) / (segment->youngs_modulus_pa * segment->second_moment_m4);
    left_m += c;
  }
  return sum;
}

double axial_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double sum = 0.0;
  for (const BeamSegment& segment : segments) {
    sum += segment.length_m / (segment.youngs_modulus_pa * segment.area_m2);
  }
  return sum;
}

}  // namespace touchstone::fast
