#include "fast/surface/contact_hats.h"

namespace touchstone::fast {
namespace {

/// Smallest independent part of a contact point's kernel function. For two points at distance s, relative to the patch,
/// it is about 4 s.
constexpr double pivot_min = 1.0 / 32.0;

}  // namespace

ContactHats::ContactHats(std::size_t patches, std::size_t capacity)
    : patches_(patches), top_(capacity), part_(capacity * patches), factor_(capacity * capacity, 0.0) {}

void ContactHats::add(const SurfacePatches& rest, const ContactPoint& contact, decltype(hat_part)* part_of) noexcept {
  const std::size_t i = count_++, n = capacity();
  top_[i] = {static_cast<std::size_t>(contact.patch), contact.place,
             contact.displacement_m.squaredNorm() > 0.0 && !contact.place.held()};
  const Patch& from = rest.patches[top_[i].patch];
  for (std::size_t p = 0; p < patches_; ++p) {
    part_[i * patches_ + p] = takes_part(i) ? part_of(from, contact.place, rest.patches[p]) : HatPart{};
  }
  std::vector<double>& a = factor_;
  for (std::size_t k = 0; k < i; ++k) {
    double below = at_contact(k, i), above = at_contact(i, k);
    for (std::size_t m = 0; m < k; ++m) {
      below -= a[i * n + m] * a[m * n + k];
      above -= a[k * n + m] * a[m * n + i];
    }
    a[i * n + k] = below / a[k * n + k];
    a[k * n + i] = above;
  }
  double pivot = 1.0;
  for (std::size_t m = 0; m < i; ++m) pivot -= a[i * n + m] * a[m * n + i];
  a[i * n + i] = std::max(pivot, pivot_min);
}

std::size_t ContactHats::memory_bytes() const noexcept {
  return top_.size() * sizeof(Top) + part_.size() * sizeof(HatPart) + factor_.size() * sizeof(double);
}

}  // namespace touchstone::fast
