// Bullet's deformable body, a cube under a ball.
#pragma once

#include "compare/model/request.h"

namespace touchstone::compare {

[[nodiscard]] std::vector<ModelEntry> bullet_models(const ModelRequest& request);

}  // namespace touchstone::compare
