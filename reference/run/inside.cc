#include "reference/run/inside.h"

#include "reference/contact/interior.h"
#include "reference/discretisation/volume_file.h"
#include "reference/mesh/sampling.h"
#include "reference/run/adaptive.h"
#include "reference/run/identity.h"
#include "reference/run/model_choice.h"
#include "reference/run/sensitivity.h"
#include "reference/run/step_record.h"
#include "reference/run/store.h"
#include "reference/run/uncertainty.h"
#include "scene/base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace touchstone::reference {
namespace {

/// The rows of a 3 x 3 matrix by columns that differ, and their names.
struct Component {
  const char* name;
  int row;
};
template <int dim>
std::vector<Component> components() {
  if constexpr (dim == 2) return {{"rr", 0}, {"zz", 4}, {"tt", 8}, {"rz", 1}};
  return {{"xx", 0}, {"yy", 4}, {"zz", 8}, {"xy", 1}, {"yz", 5}, {"xz", 2}};
}

template <int dim>
class StoredInside : public Inside {
 public:
  StoredInside(const scene::Scene& scene, const Result& result, const std::filesystem::path& store,
               const ModelChoice& choice)
      : scene_(scene),
        result_(result),
        choice_(choice),
        store_(store, identity_text(scene), [] {}),
        meshes_(result.levels.size()) {}

  [[nodiscard]] PointValues at(const Eigen::Matrix3Xd& points_m, std::size_t instant) const override {
    return at(sampler(mesh(finest()), points_m), mesh(finest()), solved(finest(), instant));
  }

  [[nodiscard]] std::vector<ProbeInstant> probes() const override {
    Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(scene_.probes.size()));
    for (std::size_t k = 0; k < scene_.probes.size(); ++k) {
      points_m.col(static_cast<Eigen::Index>(k)) = scene_.probes[k].position_m;
    }
    std::vector<int> unknowns;
    std::vector<std::vector<Eigen::Matrix3Xd>> displacement_m(meshes_.size());
    std::vector<std::vector<Eigen::Matrix<double, 9, Eigen::Dynamic>>> stress_pa(meshes_.size());
    for (int level = 0; level <= finest(); ++level) {
      unknowns.push_back(result_.levels[level].unknowns);
      const BodySampler<dim> sampler = this->sampler(mesh(level), points_m);
      for (std::size_t i = 0; i < result_.instants.size(); ++i) {
        PointValues values = at(sampler, mesh(level), solved(level, i));
        displacement_m[level].push_back(std::move(values.displacement_m));
        stress_pa[level].push_back(std::move(values.stress_pa));
      }
    }
    const std::vector<double> finer = fineness(scene_, dim, unknowns);
    const auto bands_m = point_band(displacement_m, finer), bands_pa = point_band(stress_pa, finer);
    std::vector<ProbeInstant> probes;
    for (std::size_t i = 0; i < result_.instants.size(); ++i) {
      probes.push_back({{displacement_m.back()[i], stress_pa.back()[i]}, bands_m[i], bands_pa[i]});
    }
    add_sensitivities(points_m, {displacement_m[0], stress_pa[0]}, probes);
    return probes;
  }

  [[nodiscard]] std::string volume_file(std::size_t instant) const override {
    const Discretisation<dim>& mesh = this->mesh(finest());
    const Solved<dim> solved = this->solved(finest(), instant);
    const Interior values = of(mesh, solved);
    constexpr int count = Discretisation<dim>::nodes_per_cell;
    Eigen::MatrixXd displacement_m(dim, values.stress_pa.cols());
    for (int cell = 0; cell < mesh.cell_count(); ++cell) {
      displacement_m.middleCols(Eigen::Index{count} * cell, count) = solved.state.u_m(Eigen::all, mesh.cells[cell]);
    }
    std::vector<CellField> fields = {{"displacement_m", std::move(displacement_m)}};
    for (const auto& [name, row] : components<dim>()) {
      fields.push_back({std::string("stress_") + name + "_pa", values.stress_pa.row(row)});
    }
    fields.push_back({"stress_von_mises_pa", von_mises_pa(values.stress_pa)});
    fields.push_back({"pressure_pa", pressure_pa(values.stress_pa)});
    fields.push_back({"J_minus_1", values.J_minus_1});
    return reference::volume_file(mesh, fields);
  }

 private:
  [[nodiscard]] int finest() const { return static_cast<int>(meshes_.size()) - 1; }

  [[nodiscard]] const Discretisation<dim>& mesh(int level) const {
    std::optional<Discretisation<dim>>& mesh = meshes_[level];
    if (!mesh) mesh = sequence_mesh<dim>(scene_, choice_, level, level > 0 ? &this->mesh(level - 1) : nullptr, store_);
    return *mesh;
  }

  [[nodiscard]] BodySampler<dim> sampler(const Discretisation<dim>& mesh, const Eigen::Matrix3Xd& points_m) const {
    return BodySampler<dim>(mesh, points_m, choice_.mirror_x, choice_.mirror_y);
  }

  [[nodiscard]] Solved<dim> solved(int level, std::size_t instant) const {
    const std::optional<std::string> record = store_.read(level, static_cast<int>(instant));
    auto found = record ? from_record<dim>(*record, mesh(level)) : std::nullopt;
    if (found) return std::move(found->first);
    throw scene::InputError({{store_.step_file(level, static_cast<int>(instant)).string(), 0, 0,
                              "was lost or damaged since the solve; run the command again"}});
  }

  [[nodiscard]] Interior of(const Discretisation<dim>& mesh, const Solved<dim>& solved) const {
    return interior(mesh, scene_.body.material, scene_.reference.kinematics, solved.state);
  }

  [[nodiscard]] PointValues at(const BodySampler<dim>& sampler, const Discretisation<dim>& mesh,
                               const Solved<dim>& solved) const {
    return {sampler.vectors(solved.state.u_m), sampler.tensors(of(mesh, solved).stress_pa)};
  }

  /// Values of the coarsest mesh per instant.
  struct Coarsest {
    const std::vector<Eigen::Matrix3Xd>& displacement_m;
    const std::vector<Eigen::Matrix<double, 9, Eigen::Dynamic>>& stress_pa;
  };

  /// What the differences of the meshes do not show; unknown where it is unknown of the force.
  void add_sensitivities(const Eigen::Matrix3Xd& points_m, const Coarsest& coarsest,
                         std::vector<ProbeInstant>& probes) const {
    const auto& instants = result_.instants;
    const auto deepest =
        static_cast<std::size_t>(std::max_element(instants.begin(), instants.end(),
                                                  [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; }) -
                                 instants.begin());
    for (const Sensitivity& one : result_.sensitivities) {
      const double share = share_at(one, finest());
      if (share == 0.0) continue;
      const auto changed = stored_sensitivity<dim>(scene_, choice_, mesh(0), store_, one.part);
      if (!changed)
        throw scene::InputError("the store has lost the sensitivity to the " + one.part + "; run the command again");
      const PointValues values = at(sampler(changed->mesh, points_m), changed->mesh, changed->solved);
      const Eigen::VectorXd change_m = (values.displacement_m - coarsest.displacement_m[deepest]).colwise().norm();
      const Eigen::Matrix<double, 9, Eigen::Dynamic> change_pa = values.stress_pa - coarsest.stress_pa[deepest];
      for (std::size_t i = 0; i < probes.size(); ++i) {
        const double part = share * instants[i].depth_m / instants[deepest].depth_m;
        probes[i].displacement_uncertainty_m += part * change_m;
        probes[i].stress_uncertainty_pa += part * change_pa.colwise().norm().transpose();
      }
    }
    for (std::size_t i = 0; i < probes.size(); ++i) {
      if (!std::isnan(instants[i].force_uncertainty_n)) continue;
      probes[i].displacement_uncertainty_m.setConstant(std::numeric_limits<double>::quiet_NaN());
      probes[i].stress_uncertainty_pa.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }

  const scene::Scene& scene_;
  const Result& result_;
  ModelChoice choice_;
  Store store_;
  mutable std::vector<std::optional<Discretisation<dim>>> meshes_;  // made when they are needed
};

}  // namespace

Eigen::RowVectorXd pressure_pa(const Eigen::Matrix<double, 9, Eigen::Dynamic>& stress_pa) {
  // Not minus zero at rest.
  return (0.0 - (stress_pa.row(0) + stress_pa.row(4) + stress_pa.row(8)).array() / 3.0).matrix();
}

Eigen::RowVectorXd von_mises_pa(const Eigen::Matrix<double, 9, Eigen::Dynamic>& stress_pa) {
  Eigen::Matrix<double, 9, Eigen::Dynamic> deviator = stress_pa;
  for (const int row : {0, 4, 8}) deviator.row(row) += pressure_pa(stress_pa);
  return std::sqrt(1.5) * deviator.colwise().norm();
}

std::unique_ptr<Inside> inside(const scene::Scene& scene, const Result& result, const std::filesystem::path& store) {
  const ModelChoice choice = choose_model(scene);
  if (choice.dim == 2) return std::make_unique<StoredInside<2>>(scene, result, store, choice);
  return std::make_unique<StoredInside<3>>(scene, result, store, choice);
}

}  // namespace touchstone::reference
