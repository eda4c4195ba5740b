// Which symmetries a placed tool has, found on its surface.
#pragma once

#include "scene/model/scene.h"

namespace touchstone::reference {

/// True when the map of the world (a mirror, a rotation about an axis through the origin) takes the tool to itself, to
/// a millionth of its size. Of a mesh the vertices must find partners within 3e-5 of its size and with normals within
/// 0.15: the direction in which its facets are cut into triangles matters less than the facets themselves.
[[nodiscard]] bool maps_to_itself(const scene::Tool& tool, const scene::Pose& pose, const scene::Mat3& map);

/// True when the motion from one pose to another is its own image under the map: what friction asks for besides.
[[nodiscard]] bool moves_alike(const scene::Pose& from, const scene::Pose& to, const scene::Mat3& map);

}  // namespace touchstone::reference
