// The engine of a scene's formulation.
#pragma once

#include "fast/step/engine.h"
#include "scene/model/scene.h"

#include <memory>

namespace touchstone::fast {

/// @param scene  validated; may go out of scope
/// @throws scene::InputError  where the response model's file is not there, as of stored_response()
[[nodiscard]] std::unique_ptr<Engine> make_engine(const scene::Scene& scene);

}  // namespace touchstone::fast
