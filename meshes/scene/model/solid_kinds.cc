#include "scene/model/solid_kinds.h"

#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::scene {
namespace {

template <class T, auto length>
std::unique_ptr<const Shape> made_of(const Solid& solid, const Vec3& origin_m) {
  return std::make_unique<T>(origin_m, solid.*length);
}

std::unique_ptr<const Shape> of_profile(const Solid& solid, const Vec3& origin_m) {
  return std::make_unique<Revolution>(solid.profile, origin_m);
}

}  // namespace

const std::vector<SolidKind>& solid_kinds() {
  static const std::vector<SolidKind> all = {
      {.word = "box",
       .shape = BodyShape::box,
       .flat_bottom = true,
       .lengths = {&Solid::size_m},
       .lengths_text = "three edge lengths, such as 60x60x40mm",
       .surface = made_of<Box, &Solid::size_m>},
      {.word = "sphere",
       .shape = BodyShape::sphere,
       .lengths = {&Solid::radius_m},
       .lengths_text = "its radius, such as 30mm",
       .surface = made_of<Sphere, &Solid::radius_m>,
       .turned = [](const Solid& solid) { return TurnedForm{capsule_profile(solid.radius_m, 0.0)}; }},
      {.word = "ellipsoid",
       .shape = BodyShape::ellipsoid,
       .lengths = {&Solid::semi_axes_m},
       .lengths_text = "three semi-axes, such as 40x40x30mm",
       .surface = made_of<Ellipsoid, &Solid::semi_axes_m>,
       .turned =
           [](const Solid& solid) {
             const Vec3& a_m = solid.semi_axes_m;
             return TurnedForm{capsule_profile(a_m.z(), 0.0), a_m.head<2>() / a_m.z()};
           }},
      {.word = "revolution",
       .shape = BodyShape::revolution,
       .lengths = {&Solid::profile},
       .surface = of_profile,
       .turned = [](const Solid& solid) { return TurnedForm{solid.profile}; }},
      {.word = "cylinder",
       .shape = BodyShape::revolution,
       .flat_bottom = true,
       .lengths = {&Solid::radius_m, &Solid::length_m},
       .lengths_text = "radius and height, such as 30x40mm",
       .surface = of_profile,
       .turned = [](const Solid& s) { return TurnedForm{cylinder_profile(s.radius_m, s.length_m, 0.0)}; }},
  };
  return all;
}

bool SolidKind::uses(SolidLength length) const { return std::ranges::find(lengths, length) != lengths.end(); }

bool SolidKind::named() const { return this != &nth(solid_kinds(), shape); }

const SolidKind& kind_of(const Solid& solid) {
  if (solid.named.empty()) return nth(solid_kinds(), solid.shape);
  return *std::ranges::find(solid_kinds(), solid.named, &SolidKind::word);
}

double top_curvature_per_m(const Solid& solid) {
  const SolidKind& kind = kind_of(solid);
  if (kind.turned == nullptr) return 0.0;
  const TurnedForm form = kind.turned(solid);
  const Revolution turned(form.profile);
  return turned.meridian(turned.piece_count() - 1, 1.0).curvature_along_per_m / form.stretch.prod();
}

void complete(Solid& solid) {
  if (const SolidKind& kind = kind_of(solid); kind.named()) solid.profile = kind.turned(solid).profile;
}

bool Body::flat_bottom() const noexcept {
  const SolidKind& kind = kind_of(*this);
  return kind.uses(&Solid::profile) ? scene::flat_bottom(profile) : kind.flat_bottom;
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
