#include "fast/run/make_engine.h"

#include "fast/response/response_engine.h"
#include "fast/step/skeleton_engine.h"

#include <utility>

namespace touchstone::fast {

std::unique_ptr<Engine> make_engine(const scene::Scene& scene) {
  if (scene.fast.formulation != scene::Formulation::response) return std::make_unique<SkeletonEngine>(scene);
  scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  scene::Response response = stored_response(scene, surface);
  return std::make_unique<ResponseEngine>(scene, std::move(surface), std::move(response));
}

}  // namespace touchstone::fast
