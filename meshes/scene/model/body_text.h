// A body in words: what the keys of stored results are made from.
#pragma once

#include "scene/model/scene.h"

#include <string>

namespace touchstone::scene {

/// Shape, support, material and inclusions to all digits; two bodies have the same text only if they are equal.
[[nodiscard]] std::string body_text(const Body& body);

}  // namespace touchstone::scene
