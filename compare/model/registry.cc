#include "compare/model/registry.h"

#include "compare/input/tuning_study.h"
#include "compare/model/bullet_model.h"
#include "compare/model/compliance_model.h"
#include "compare/model/reference_model.h"
#include "compare/model/response_model.h"
#include "compare/model/skeleton_model.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

namespace touchstone::compare {
namespace {

/// One for every file of tuned constants.
std::vector<ModelEntry> tuned_models(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  for (const std::filesystem::path& file : request.parameters) {
    const auto tuned = [file](scene::Scene scene) { return with_parameters(std::move(scene), file); };
    ModelEntry& entry = models.emplace_back(changed(fast_model(tuned(request.scene), request.say), tuned));
    entry.name += ", tuned (" + file.filename().string() + ")";
    entry.key = "tuned-" + file.stem().string();
    entry.label += ", tuned";
    entry.own = false;
  }
  return models;
}

}  // namespace

ModelEntry fast_model(const scene::Scene& scene, const Say& say) {
  using scene::Formulation;
  static const std::map<Formulation, ModelEntry (*)(const scene::Scene&, const Say&)> models = {
      {Formulation::published, skeleton_model},
      {Formulation::corrected, skeleton_model},
      {Formulation::response, response_model},
  };
  ModelEntry entry = models.at(scene.fast.formulation)(scene, say);
  entry.own = true;
  return entry;
}

void prepare_missing(const scene::Scene& scene, const Say& say) {
  if (const ModelEntry entry = fast_model(scene); entry.prepare) entry.prepare(scene, say);
}

const std::vector<ModelList>& registered_models() {
  static const std::vector<ModelList> models{
      skeleton_models, tuned_models,      skeleton_meshes, skeleton_anchor_sets,
      response_models, compliance_models, bullet_models,   reference_models,
  };
  return models;
}

std::vector<ModelEntry> list_models(const ModelRequest& request, const std::vector<ModelList>& kinds) {
  std::vector<ModelEntry> models;
  for (const ModelList list : kinds) {
    for (ModelEntry& entry : list(request)) models.push_back(std::move(entry));
  }
  return models;
}

ModelEntry find_model(const ModelRequest& request, const std::string& key, const std::vector<ModelList>& kinds) {
  std::vector<std::string> keys;
  for (ModelEntry& entry : list_models(request, kinds)) {
    if (entry.key == key && !entry.absent.empty()) {
      throw scene::InputError(fmt::format("model \"{}\" is absent: {}", key, entry.absent));
    }
    if (entry.triangles || !entry.absent.empty()) continue;
    if (entry.key == key) return std::move(entry);
    keys.push_back(entry.key);
  }
  throw scene::InputError(fmt::format("no model has the key \"{}\"; expected one of {}{}", key, fmt::join(keys, ", "),
                                      scene::did_you_mean(key, keys)));
}

}  // namespace touchstone::compare
