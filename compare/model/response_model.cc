#include "compare/model/response_model.h"

#include "compare/model/engine_model.h"
#include "scene/response/response.h"

#include <utility>

namespace touchstone::compare {

scene::Scene with_response(scene::Scene scene) {
  scene.fast.formulation = scene::Formulation::response;
  return scene;
}

ModelEntry response_model(ModelEntry entry, const SceneChange& change, const ModelRequest& request) {
  entry.method = "half space, response";
  entry.family = ModelFamily::response;
  entry.set_up = [change, say = request.say](const scene::Scene& given) {
    if (const std::string needs = scene::response_needs(given); !needs.empty()) {
      throw Unavailable("the response model needs that " + needs);
    }
    return engine_model(change(given), say);
  };
  return entry;
}

std::vector<ModelEntry> response_models(const ModelRequest& request) {
  return {response_model(
      {.name = "response, from the material and the body's linear response", .key = "response", .label = "response"},
      with_response, request)};
}

}  // namespace touchstone::compare
