#include "reference/run/adaptive.h"

#include "reference/discretisation/refinement.h"
#include "reference/linear/record.h"
#include "reference/mesh/inclusions.h"
#include "reference/mesh/mesh_limit.h"
#include "reference/run/step_record.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

namespace touchstone::reference {
namespace {

/// From the solutions of the mesh in the store.
template <int dim>
std::vector<char> worst_over_track(const scene::Scene& scene, const Discretisation<dim>& mesh, int level,
                                   const Store& store) {
  const auto body = scene::body_shape(scene.body);
  std::vector<double> depths_m;
  for (const double time_s : scene::instants_s(scene)) {
    depths_m.push_back(scene::rest_depth_m(*body, scene.tool, scene::pose_at(scene.track, time_s)));
  }
  const double least_m = deep_share * *std::max_element(depths_m.begin(), depths_m.end());
  Eigen::VectorXd worst = Eigen::VectorXd::Zero(mesh.cell_count());
  for (std::size_t instant = 0; instant < depths_m.size(); ++instant) {
    if (depths_m[instant] <= std::max(least_m, grazing_depth_m)) continue;
    const auto record = store.read(level, static_cast<int>(instant));
    const auto found = record ? from_record<dim>(*record, mesh) : std::nullopt;
    if (!found) throw std::runtime_error("the store has lost a solution of mesh " + std::to_string(level + 1));
    const Eigen::VectorXd squared = squared_error_estimate<dim>(mesh, found->first.state.u_m);
    if (squared.sum() > 0.0) worst = worst.cwiseMax(squared / squared.sum());
  }
  return worst_cells(worst, *scene.reference.adaptive_share);
}

}  // namespace

template <int dim>
Discretisation<dim> sequence_mesh(const scene::Scene& scene, const ModelChoice& choice, int level,
                                  const Discretisation<dim>* coarser, const Store& store) {
  if (level == 0 || !scene.reference.adaptive_share) return level_mesh<dim>(scene, choice, level);
  const std::string name = "divided-" + std::to_string(level);
  std::vector<char> divided;
  if (const auto record = store.read(name)) divided.assign(record->begin(), record->end());
  if (static_cast<int>(divided.size()) != coarser->cell_count()) {
    divided = worst_over_track(scene, *coarser, level - 1, store);
    store.write(name, std::string_view(divided.data(), divided.size()));
  }
  if (coarser->cell_count() + ((1 << dim) - 1.0) * std::count(divided.begin(), divided.end(), 1) > most_cells) {
    throw MeshTooLarge("the mesh would have more than " + std::to_string(most_cells) + " cells");
  }
  Discretisation<dim> mesh = coarser->refined(divided);
  embed_inclusions(scene.body, mesh);
  return mesh;
}

std::vector<double> fineness(const scene::Scene& scene, int dim, const std::vector<int>& unknowns) {
  std::vector<double> finer;
  for (std::size_t level = 0; level < unknowns.size(); ++level) {
    const double ratio = static_cast<double>(unknowns[level]) / unknowns[0];
    finer.push_back(scene.reference.adaptive_share ? std::pow(ratio, 2.0 / dim) : refinement(static_cast<int>(level)));
  }
  return finer;
}

BandRule force_rule(const scene::Scene& scene, int dim, const std::vector<scene::ReferenceInstant>& instants) {
  if (!scene.reference.adaptive_share) return {};
  constexpr double most_order_in_space = 1.2;  // in (N / N1)^(2/3)
  return {.most_order = dim == 3 ? most_order_in_space : 1.0, .refined_for = deep_instants(instants)};
}

double adaptive_growth(const scene::Scene& scene, int dim) {
  return 1.0 + ((1 << dim) - 1) * scene.reference.adaptive_share.value_or(0.0);
}

template Discretisation<2> sequence_mesh(const scene::Scene&, const ModelChoice&, int, const Discretisation<2>*,
                                         const Store&);
template Discretisation<3> sequence_mesh(const scene::Scene&, const ModelChoice&, int, const Discretisation<3>*,
                                         const Store&);

}  // namespace touchstone::reference
