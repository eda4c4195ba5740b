#include "compare/model/compliance_model.h"

#include "compare/model/linear_contact.h"
#include "reference/linear_response.h"
#include "reference/run/model_choice.h"

#include <fmt/format.h>

namespace touchstone::compare {
namespace {

class ComplianceModel final : public ContactModel {
 public:
  ComplianceModel(const reference::LinearResponse& response, const scene::Scene& scene)
      : contact_(response, scene.tool), size_(response.unknowns) {
    note_ =
        fmt::format("{}, {} nodes may be touched; displacements only, no normals", response.model, contact_.nodes());
    if (reference::choose_model(scene).dim == 2) {
      note_ += "; a tool that leaves the axis would need the whole body";
    }
  }

  void step(const scene::Pose& pose) override { contact_.step(pose); }

  void answer(scene::Answer& asked) override {
    for (scene::InstantRecord& instant : asked.instants) {
      contact_.step(instant.tool);
      solved_ = solved_ && contact_.solved();
      instant.displacement_m = contact_.displacement_m();
      if (contact_.touching() == 0) continue;
      instant.regions.push_back({.depth_m = instant.depth_m, .force_n = contact_.force_n()});
    }
  }

  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] std::optional<double> memory_bytes() const override {
    return static_cast<double>(contact_.memory_bytes());
  }
  [[nodiscard]] std::string note() const override { return note_; }
  [[nodiscard]] std::string trouble() const override { return solved_ ? "" : "some contact was not found"; }

 private:
  LinearContact contact_;
  int size_;
  std::string note_;
  bool solved_ = true;
};

std::unique_ptr<ContactModel> set_up(const scene::Scene& scene, int level) {
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  try {
    return std::make_unique<ComplianceModel>(reference::linear_response(scene, surface.points_m, {.level = level}),
                                             scene);
  } catch (const reference::Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw Unavailable(error.what());
  }
}

}  // namespace

std::vector<ModelEntry> compliance_models(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  for (int level = 0; level < (request.quick ? 1 : 2); ++level) {
    models.push_back({.name = fmt::format("linear compliance, mesh {}", level + 1),
                      .key = fmt::format("compliance-{}", level + 1),
                      .label = fmt::format("compliance {}", level + 1),
                      .family = ModelFamily::compliance,
                      .set_up = [level](const scene::Scene& scene) { return set_up(scene, level); }});
  }
  return models;
}

}  // namespace touchstone::compare
