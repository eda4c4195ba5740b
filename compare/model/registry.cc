#include "compare/model/registry.h"

#include "compare/model/bullet_model.h"
#include "compare/model/compliance_model.h"
#include "compare/model/reference_model.h"
#include "compare/model/skeleton_model.h"

namespace touchstone::compare {

const std::vector<ModelList>& registered_models() {
  static const std::vector<ModelList> models{
      skeleton_models, skeleton_meshes, skeleton_anchor_sets, compliance_models, bullet_models, reference_models,
  };
  return models;
}

}  // namespace touchstone::compare
