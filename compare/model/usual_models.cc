#include "compare/model/usual_models.h"

#include "compare/input/tuning_study.h"
#include "compare/model/registry.h"
#include "compare/model/response_model.h"
#include "compare/model/skeleton_model.h"
#include "scene/input/fields.h"

#include <algorithm>
#include <utility>

namespace touchstone::compare {
namespace {

bool same_model(const scene::Scene& a, const scene::Scene& b) {
  const auto constants = scene::tunable_fields(a);
  return constants == scene::tunable_fields(b) && std::ranges::all_of(constants, [&](const auto* field) {
           return scene::value_text(*field, a) == scene::value_text(*field, b);
         });
}

}  // namespace

std::vector<ModelEntry> usual_models(const ModelRequest& request) {
  const scene::Scene& given = request.scene;
  const bool has_tuned = !request.parameters.empty();
  std::vector<ModelEntry> models;
  std::vector<scene::Scene> scenes;
  const auto add = [&](const std::string& key, const std::string& name, const SceneChange& change, bool tuned = false) {
    scene::Scene scene = change(given);
    const auto same = [&](const scene::Scene& other) { return same_model(other, scene); };
    if (!tuned && std::ranges::any_of(scenes, same)) return;
    ModelEntry& entry = models.emplace_back(changed(fast_model(scene, request.say), change));
    entry.key = key;
    entry.name = name;
    entry.own = has_tuned ? tuned : same_model(scene, given);
    scenes.push_back(std::move(scene));
  };
  if (given.contact.law == scene::ContactLaw::duffing) add("paper", "paper as printed", as_printed);
  add("area_aware", "untuned, from the material",
      [](scene::Scene scene) { return with_untuned_area_law(corrected(std::move(scene))); });
  add("response", given.fast.body_falloff_per_m > 0.0 ? "response, scene's falloff" : "response, untuned",
      with_response);
  add("scene", "scene's own constants", [](scene::Scene scene) { return scene; });
  if (has_tuned) {
    const std::filesystem::path& file = request.parameters.front();
    add(
        "tuned", "tuned: " + file.filename().string(),
        [file](scene::Scene scene) { return with_parameters(std::move(scene), file); }, true);
  }
  return models;
}

}  // namespace touchstone::compare
