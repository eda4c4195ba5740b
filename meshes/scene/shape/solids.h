// Every shape of a solid.
#pragma once

#include "scene/shape/box.h"
#include "scene/shape/ellipsoid.h"
#include "scene/shape/revolution.h"
#include "scene/shape/sphere.h"

namespace touchstone::scene {

template <class... Bodies>
struct SolidList {};
/// Loops over points are compiled for each of these; a shape that is not among them has none.
using Solids = SolidList<Box, Sphere, Ellipsoid, Revolution>;

namespace detail {
template <class Result, class Use, class... Bodies>
Result as_solid(const Shape& shape, const Use& use, SolidList<Bodies...>) {
  Result result{};
  (void)((dynamic_cast<const Bodies*>(&shape) != nullptr && (result = use.template operator()<Bodies>(), true)) || ...);
  return result;
}
}  // namespace detail

/// What `use` gives for the class of the shape, as in `use.template operator()<Box>()`; Result{} for none of the list.
template <class Result, class Use>
[[nodiscard]] Result as_solid(const Shape& shape, const Use& use) {
  return detail::as_solid<Result>(shape, use, Solids{});
}

}  // namespace touchstone::scene
