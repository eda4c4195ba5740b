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

/// A solid as a profile turned about z, then stretched along x and y.
struct TurnedForm {
  Profile profile;
  Eigen::Vector2d stretch = Eigen::Vector2d::Ones();
};

struct SolidKind {
  std::string_view word;     ///< in scene files
  BodyShape shape;           ///< of a solid with a name: revolution
  bool flat_bottom = false;  ///< that of a revolution follows from its profile
  std::vector<SolidLength> lengths;
  std::string_view lengths_text = {};  ///< for `new`, which takes the lengths in this order; empty: not by `new`
  /// The surface, the origin of its own axes at origin_m.
  std::unique_ptr<const Shape> (*surface)(const Solid& solid, const Vec3& origin_m);
  TurnedForm (*turned)(const Solid& solid) = nullptr;  ///< null: it has no such form

  [[nodiscard]] bool uses(SolidLength length) const;
  /// Its name and lengths stand for a profile.
  [[nodiscard]] bool named() const;
};

/// In the order of BodyShape, then those whose name stands for a profile.
[[nodiscard]] const std::vector<SolidKind>& solid_kinds();

/// The kind that a scene file gives the solid.
[[nodiscard]] const SolidKind& kind_of(const Solid& solid);

/// Geometric mean of the principal curvatures at the top [1/m]; 0 where there is no turned form.
[[nodiscard]] double top_curvature_per_m(const Solid& solid);

}  // namespace touchstone::scene
