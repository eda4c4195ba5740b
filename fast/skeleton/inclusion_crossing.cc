#include "fast/skeleton/inclusion_crossing.h"

#include <algorithm>

namespace touchstone::fast {

using scene::Crossing;
using scene::Vec3;

std::vector<Inclusion> inclusions_of(const scene::Body& body) {
  std::vector<Inclusion> inclusions;
  for (const scene::Inclusion& part : body.inclusions) {
    if (inclusions.size() == inclusions_max) break;
    inclusions.push_back({scene::solid_shape(part, part.center_m), part.material.youngs_modulus_pa});
  }
  return inclusions;
}

BeamSegments cut_beam(std::span<const Inclusion> inclusions, const Vec3& anchor_m, const Vec3& contact_m,
                      const BeamMaterial& beam) noexcept {
  std::array<Crossing, inclusions_max> crossing;
  std::array<double, segments_max + 1> cut_m{};
  const std::size_t count = std::min(inclusions.size(), inclusions_max);
  const double line_m = (contact_m - anchor_m).norm();
  const double stretch = line_m > 0.0 ? beam.length_m / line_m : 1.0;
  std::size_t cuts = 1;  // the first stays at 0
  for (std::size_t i = 0; i < count; ++i) {
    crossing[i] = inclusions[i].shape->crossing(anchor_m, contact_m);
    if (crossing[i].empty()) continue;
    cut_m[cuts++] = crossing[i].enter_m;
    cut_m[cuts++] = crossing[i].leave_m;
  }
  std::sort(cut_m.begin() + 1, cut_m.begin() + static_cast<std::ptrdiff_t>(cuts));
  cut_m[cuts++] = line_m;

  const double second_moment = second_moment_m4(beam.area_m2);
  BeamSegments segments;
  if (cuts == 2) {
    segments.segment[segments.count++] = {beam.length_m, beam.youngs_modulus_pa, beam.area_m2, second_moment};
    return segments;
  }
  for (std::size_t c = 1; c < cuts; ++c) {
    const double length_m = cut_m[c] - cut_m[c - 1];
    if (!(length_m > 0.0)) continue;
    const double middle_m = 0.5 * (cut_m[c] + cut_m[c - 1]);
    double youngs_modulus_pa = beam.youngs_modulus_pa;
    for (std::size_t i = 0; i < count; ++i) {
      const bool within = crossing[i].enter_m < middle_m && middle_m < crossing[i].leave_m;
      if (within) youngs_modulus_pa = inclusions[i].youngs_modulus_pa;
    }
    segments.segment[segments.count++] = {stretch * length_m, youngs_modulus_pa, beam.area_m2, second_moment};
  }
  return segments;
}

}  // namespace touchstone::fast
