#include "compare/model/response_model.h"

#include "compare/model/engine_model.h"
#include "scene/response/response.h"

#include <utility>

namespace touchstone::compare {

scene::Scene with_response(scene::Scene scene) {
  scene.fast.formulation = scene::Formulation::response;
  return scene;
}

std::vector<ModelEntry> response_models(const ModelRequest& request) {
  return {{.name = "response, from the material and the body's linear response",
           .key = "response",
           .label = "response",
           .method = "half space, response",
           .family = ModelFamily::response,
           .set_up = [say = request.say](const scene::Scene& given) {
             if (const std::string needs = scene::response_needs(given); !needs.empty()) {
               throw Unavailable("the response model needs that " + needs);
             }
             return engine_model(with_response(given), say);
           }}};
}

}  // namespace touchstone::compare
