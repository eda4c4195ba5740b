#include "scene/shape/surface.h"

namespace touchstone::scene {

Surface tessellate(const Shape& shape, int triangles) { return shape.tessellated(triangles); }

}  // namespace touchstone::scene
