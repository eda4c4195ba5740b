// What makes one answer of the reference different from another.
#pragma once

#include "scene/model/scene.h"

#include <string>

namespace touchstone::reference {

/// Everything that changes the answer on a level, nothing else, as text that a reader can compare: its hash is the
/// content address. How many levels are solved is not part of it, so that a finer run goes on where a coarser ended.
[[nodiscard]] std::string identity_text(const scene::Scene& scene);

}  // namespace touchstone::reference
