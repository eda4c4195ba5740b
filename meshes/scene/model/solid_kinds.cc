#include "scene/model/solid_kinds.h"

#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::scene {
namespace {

template <class T, auto length>
std::unique_ptr<const Shape> made_of(const Solid& solid, const Vec3& origin_m) {
  return std::make_unique<T>(origin_m, solid.*length);
}

std::unique_ptr<const Shape> turned(const Solid& solid, const Vec3& origin_m) {
  return std::make_unique<Revolution>(solid.profile, origin_m);
}

const NamedProfile* profile_of(const Solid& solid) {
  const auto all = named_profiles();
  const auto found = std::ranges::find(all, solid.named, &NamedProfile::name);
  return found != all.end() ? &*found : nullptr;
}

}  // namespace

std::span<const NamedProfile> named_profiles() {
  static constexpr NamedProfile all[] = {
      {"cylinder", true, [](const Solid& solid) { return cylinder_profile(solid.radius_m, solid.length_m, 0.0); }},
  };
  return all;
}

const std::vector<SolidKind>& solid_kinds() {
  static const std::vector<SolidKind> all = {
      {"box", BodyShape::box, true, {&Solid::size_m}, made_of<Box, &Solid::size_m>},
      {"sphere", BodyShape::sphere, false, {&Solid::radius_m}, made_of<Sphere, &Solid::radius_m>},
      {"ellipsoid", BodyShape::ellipsoid, false, {&Solid::semi_axes_m}, made_of<Ellipsoid, &Solid::semi_axes_m>},
      {"revolution", BodyShape::revolution, false, {&Solid::profile}, turned},
      {"cylinder", BodyShape::revolution, false, {&Solid::radius_m, &Solid::length_m}, turned},
  };
  return all;
}

bool SolidKind::uses(SolidLength length) const { return std::ranges::find(lengths, length) != lengths.end(); }

bool SolidKind::named() const { return this != &nth(solid_kinds(), shape); }

const SolidKind& kind_of(const Solid& solid) {
  if (solid.named.empty()) return nth(solid_kinds(), solid.shape);
  return *std::ranges::find(solid_kinds(), solid.named, &SolidKind::word);
}

void complete(Solid& solid) {
  if (const NamedProfile* found = profile_of(solid)) solid.profile = found->profile(solid);
}

bool Body::flat_bottom() const noexcept {
  if (shape != BodyShape::revolution) return kind_of(*this).flat_bottom;
  const NamedProfile* found = profile_of(*this);
  return found != nullptr ? found->flat_bottom : scene::flat_bottom(profile);
}

std::unique_ptr<const Shape> solid_shape(const Solid& solid, const Vec3& center_m) {
  const SolidKind& kind = kind_of(solid);
  const Bounds own = kind.surface(solid, Vec3::Zero())->bounds();
  return kind.surface(solid, center_m - 0.5 * (own.lower_m + own.upper_m));
}

std::unique_ptr<const Shape> body_shape(const Body& body) {
  const SolidKind& kind = kind_of(body);
  // Not through the centre, so that the bottom is exactly at zero.
  return kind.surface(body, Vec3(0.0, 0.0, -kind.surface(body, Vec3::Zero())->bounds().lower_m.z()));
}

}  // namespace touchstone::scene
