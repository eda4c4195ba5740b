// The shapes of bodies and inclusions: their names in scene files, the lengths that give them, and their surfaces.
#pragma once

#include "scene/model/scene.h"

#include <memory>
#include <string_view>
#include <variant>
#include <vector>

namespace touchstone::scene {

/// Members of Solid that hold lengths.
using SolidLength = std::variant<double Solid::*, Vec3 Solid::*, Profile Solid::*>;

struct SolidKind {
  std::string_view word;  ///< in scene files
  BodyShape shape;        ///< of a solid with a name: revolution
  bool flat_bottom;       ///< that of a revolution follows from its profile
  std::vector<SolidLength> lengths;
  /// The surface, the origin of its own axes at origin_m.
  std::unique_ptr<const Shape> (*surface)(const Solid& solid, const Vec3& origin_m);

  [[nodiscard]] bool uses(SolidLength length) const;
  /// The name is that of a profile.
  [[nodiscard]] bool named() const;
};

/// In the order of BodyShape, then those that have the name of a profile.
[[nodiscard]] const std::vector<SolidKind>& solid_kinds();

/// The kind that a scene file gives the solid.
[[nodiscard]] const SolidKind& kind_of(const Solid& solid);

}  // namespace touchstone::scene
