#include "fast/skeleton/beam.h"

#include <numbers>

namespace touchstone::fast {
namespace {

/// Integral of t^2 / (E I) over a segment that begins at t = b: c (b^2 + b c + c^2 / 3), a form without cancellation.
double squared_arm(const BeamSegment& segment, double b) noexcept {
  const double c = segment.length_m;
  return c * (b * b + b * c + c * c / 3.0) / (segment.youngs_modulus_pa * segment.second_moment_m4);
}

}  // namespace

double second_moment_m4(double area_m2) noexcept { return area_m2 * area_m2 / (4.0 * std::numbers::pi); }

double bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double left_m = 0.0;  // l - x at the segment's far end
  double sum = 0.0;
  for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
    sum += squared_arm(*segment, left_m);
    left_m += segment->length_m;
  }
  return sum;
}

double released_bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double x_m = 0.0;
  double sum = 0.0;
  for (const BeamSegment& segment : segments) {
    sum += squared_arm(segment, x_m);
    x_m += segment.length_m;
  }
  return sum;
}

double printed_bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double left_m = 0.0;
  for (const BeamSegment& segment : segments) left_m += segment.length_m;
  double a = 0.0;
  double sum = 0.0;
  for (const BeamSegment& segment : segments) {
    const double c = segment.length_m;
    left_m = left_m > c ? left_m - c : 0.0;
    // With l = a + c + left: the integral of l x - x^2 / 2 from a to a + c.
    const double integral = c * (0.5 * a * a + a * c + c * c / 3.0 + left_m * (a + 0.5 * c));
    sum += integral / (segment.youngs_modulus_pa * segment.second_moment_m4);
    a += c;
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

double printed_axial_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept {
  double l_m = 0.0, stiffness = 0.0;
  for (const BeamSegment& segment : segments) {
    l_m += segment.length_m;
    stiffness += segment.youngs_modulus_pa * segment.area_m2 * segment.length_m;
  }
  return l_m * l_m / stiffness;
}

}  // namespace touchstone::fast
