#include "compare/model/registry.h"

#include "compare/model/bullet_model.h"
#include "compare/model/compliance_model.h"
#include "compare/model/reference_model.h"
#include "compare/model/response_model.h"
#include "compare/model/skeleton_model.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace touchstone::compare {

const std::vector<ModelList>& registered_models() {
  static const std::vector<ModelList> models{
      skeleton_models,   skeleton_meshes, skeleton_anchor_sets, response_models,
      compliance_models, bullet_models,   reference_models,
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
