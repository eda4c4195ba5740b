#include "compare/tune/tuning.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::compare {
namespace {

template <class T>
void keep(std::vector<T>& list, const std::vector<std::size_t>& at) {
  if (list.empty()) return;
  std::vector<T> kept;
  for (const std::size_t k : at) kept.push_back(std::move(list[k]));
  list = std::move(kept);
}

void keep_in_result(reference::Result& result, const std::vector<std::size_t>& at) {
  keep(result.instants, at);
  for (reference::LevelRecord& level : result.levels) keep(level.force_n, at);
}

}  // namespace

TuningData tuning_data(const TuningContact& contact, const SolveReference& solve) {
  TuningData data{
      contact, {}, {}, scene::tessellate(*scene::body_shape(contact.scene.body), contact.scene.fast.triangles)};
  data.result = solve(contact.scene, data.surface);
  for (std::size_t t = 0; t < data.result.instants.size(); ++t) {
    const double depth_m = data.result.instants[t].depth_m;
    const bool from_rest = contact.depth_m[0] == 0.0;
    if ((from_rest || depth_m > contact.depth_m[0]) && depth_m <= contact.depth_m[1]) data.instants.push_back(t);
  }
  keep_in_result(data.result, data.instants);
  const auto touches = [](const scene::InstantRecord& record) {
    return record.depth_m > grazing_depth_m && record.force_n().norm() > 0.0;
  };
  if (std::none_of(data.result.instants.begin(), data.result.instants.end(), touches)) {
    throw scene::InputError(
        fmt::format("contact \"{}\": the reference is never in contact at an instant that counts; "
                    "expected some with a depth in depth_m",
                    contact.name));
  }
  return data;
}

void set_values(scene::Scene& scene, const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    set_parameter(scene, parameters[k].key, values[static_cast<Eigen::Index>(k)]);
  }
}

scene::Scene tuned_scene(const scene::Scene& scene, const TunedModel& model) {
  scene::Scene out = scene;
  out.fast.formulation = model.formulation;
  out.contact.law = model.law;
  for (const StageFit& stage : model.stages) set_values(out, stage.parameters, stage.fit.value);
  return out;
}

}  // namespace touchstone::compare
