#include "fast/surface/hat.h"

#include <algorithm>

namespace touchstone::fast {
namespace {

/// Two patches meet at a crease if the cosine between their normals is smaller than this at every common anchor point.
constexpr double smooth_cosine = 0.99;

std::size_t corner_of(const Patch& patch, int anchor) noexcept {
  const auto begin = patch.anchor.begin(), end = begin + static_cast<std::ptrdiff_t>(patch.corners);
  return static_cast<std::size_t>(std::find(begin, end, anchor) - begin);
}

}  // namespace

double HatPart::at(const PatchPlace& place) const noexcept {
  double height = std::min(ceiling, per_free * place.free);
  for (std::size_t k = 0; k < base.size(); ++k) height = std::min(height, base[k] + slope[k] * place.weight[k]);
  return std::max(height, 0.0);
}

HatPart hat_part(const Patch& from, const PatchPlace& top, const Patch& to) noexcept {
  HatPart part;
  part.base.fill(1.0);
  part.ceiling = 1.0;
  for (std::size_t a = 0; a < from.corners; ++a) {
    const double slope = 1.0 / std::max(top.weight[a], hat_weight), base = 1.0 - top.weight[a] * slope;
    const std::size_t k = corner_of(to, from.anchor[a]);
    if (k == to.corners) {
      part.ceiling = std::min(part.ceiling, base);
    } else {
      part.base[k] = base;
      part.slope[k] = slope;
    }
  }
  part.per_free = 1.0 / top.free;
  return part;
}

HatPart hat_part_to_creases(const Patch& from, const PatchPlace& top, const Patch& to) noexcept {
  bool shared = false, smooth = false;
  for (std::size_t a = 0; a < from.corners; ++a) {
    const std::size_t k = corner_of(to, from.anchor[a]);
    if (k == to.corners) continue;
    shared = true;
    smooth = smooth || from.corner_normal[a].dot(to.corner_normal[k]) > smooth_cosine;
  }
  return shared && smooth ? hat_part(from, top, to) : HatPart{};
}

}  // namespace touchstone::fast
