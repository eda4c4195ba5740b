#include "compare/tune/training.h"

#include "compare/model/replay.h"
#include "compare/tune/findings.h"
#include "scene/model/rules.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace touchstone::compare {
namespace {

using scene::Vec3;

constexpr int profile_points = 9;

double peak_force_n(const TuningData& data) {
  double peak_n = 0.0;
  for (const scene::InstantRecord& record : data.result.instants) peak_n = std::max(peak_n, record.force_n().norm());
  return peak_n;
}

/// The reference's uncertainty, but at least the floor; the floor if the uncertainty is unknown.
double at_least(double uncertainty, double floor) {
  return std::isfinite(uncertainty) ? std::max(uncertainty, floor) : floor;
}

/// The training contacts as residuals of one stage.
class Training {
 public:
  /// @param deepest_m  largest depth of all contacts, up to which the law must be valid
  Training(const Tuning& tuning, const TunedModel& model, double deepest_m) : deepest_m_(deepest_m) {
    for (const TuningData& data : tuning.data) {
      if (data.held_out()) continue;
      Contact& one = contacts_.emplace_back();
      one.data = &data;
      one.scene = tuned_scene(data.contact.scene, model);
      one.replay = replay_of(model.entry, one.scene);
      one.force_floor_n = tuning.study.force_floor * peak_force_n(data);
      one.shape_uncertainty = at_least(data.result.shape_uncertainty_rel.value_or(INFINITY), tuning.study.shape_floor);
      for (std::size_t t = 0; t < data.instants.size(); ++t) {
        if (data.result.instants[t].depth_m > grazing_depth_m) one.touching.push_back(t);
      }
      for (const std::size_t t : one.touching) {
        const Eigen::Matrix3Xd& u_m = data.result.instants[t].displacement_m;
        for (Eigen::Index i = 0; i < u_m.cols(); ++i) {
          one.shape_scale += data.surface.vertex_area_m2[static_cast<std::size_t>(i)] * u_m.col(i).squaredNorm();
        }
      }
      one.shape_scale = std::sqrt(one.shape_scale / static_cast<double>(one.touching.size()));
      one.weight_per_m =
          Eigen::Map<const Eigen::VectorXd>(data.surface.vertex_area_m2.data(),
                                            static_cast<Eigen::Index>(data.surface.vertex_area_m2.size()))
              .cwiseSqrt() /
          (one.shape_scale * one.shape_uncertainty);
      for (const std::size_t t : one.touching) {
        one.touching_in_track.push_back(data.instants[t]);
        one.weighted_reference.push_back(data.result.instants[t].displacement_m * one.weight_per_m.asDiagonal());
        shape_rows_ += one.weighted_reference.back().size();
      }
      observations_ += static_cast<int>(one.touching.size());
    }
  }

  /// One observation per instant in contact, for the force as for the shape: displacements of one surface are
  /// correlated.
  [[nodiscard]] int observations() const noexcept { return observations_; }

  /// Difference of the force vectors over the uncertainty, three components per instant.
  std::optional<Eigen::VectorXd> force(const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
    Eigen::VectorXd out(3 * observations_);
    Eigen::Index row = 0;
    for (Contact& one : contacts_) {
      scene::Scene scene = one.scene;
      set_values(scene, parameters, values);
      if (!scene::broken_constants(scene, deepest_m_).empty()) return std::nullopt;
      const std::vector<Vec3> force_n = one.replay->forces_n(scene);
      for (const std::size_t t : one.touching) {
        const double band_n = at_least(one.data->result.instants[t].force_uncertainty_n, one.force_floor_n);
        out.segment<3>(row) = (force_n[one.data->instants[t]] - one.data->result.instants[t].force_n()) / band_n;
        row += 3;
      }
    }
    return out;
  }

  /// Difference of the displacements times sqrt(area), scaled so that the mean over the instants of the sum of squares
  /// is (shape.rel_l2 / the reference's uncertainty of it)^2.
  std::optional<Eigen::VectorXd> shape(const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
    Eigen::VectorXd out(shape_rows_);
    Eigen::Index row = 0;
    for (Contact& one : contacts_) {
      scene::Scene scene = one.scene;
      set_values(scene, parameters, values);
      if (!scene::broken_constants(scene, deepest_m_).empty()) return std::nullopt;
      if (!one.forces_known) (void)one.replay->forces_n(scene);
      one.forces_known = true;
      one.replay->displacements(scene, one.touching_in_track, [&](std::size_t k, const auto& displacement_m) {
        const Eigen::Matrix3Xd& weighted = one.weighted_reference[k];
        for (Eigen::Index i = 0; i < weighted.cols(); ++i) {
          for (Eigen::Index axis = 0; axis < 3; ++axis) {
            out[row++] = displacement_m(axis, i) * one.weight_per_m[i] - weighted(axis, i);
          }
        }
      });
    }
    return out;
  }

 private:
  struct Contact {
    const TuningData* data = nullptr;
    scene::Scene scene;
    std::unique_ptr<ModelReplay> replay;
    std::vector<std::size_t> touching;           ///< fitted instants in contact
    std::vector<std::size_t> touching_in_track;  ///< all instants in contact
    double force_floor_n = 0.0;
    double shape_uncertainty = 0.0;
    double shape_scale = 0.0;      ///< root mean square over the instants of sqrt(sum A |u|^2) [m^2]
    Eigen::VectorXd weight_per_m;  ///< per rest point: sqrt(A) over the scale and the uncertainty
    std::vector<Eigen::Matrix3Xd> weighted_reference;  ///< per fitted instant in contact
    bool forces_known = false;
  };
  double deepest_m_;
  std::vector<Contact> contacts_;
  int observations_ = 0;
  Eigen::Index shape_rows_ = 0;
};

}  // namespace

StageFit fit_stage(const Tuning& tuning, const TunedModel& model, TuningStage stage, double deepest_m) {
  StageFit out;
  out.stage = stage;
  for (const TuningParameter& one : tuning.study.parameters) {
    if (one.stage != stage || !applies(one, model.formulation, model.law)) continue;
    out.parameters.push_back(one);
    out.searched.push_back({one.key, one.low, one.high, one.start, one.log});
  }
  if (out.parameters.empty()) return out;
  Training training(tuning, model, deepest_m);
  const Residuals residuals = [&](const Eigen::VectorXd& values) {
    return stage == TuningStage::force ? training.force(out.parameters, values)
                                       : training.shape(out.parameters, values);
  };
  FitOptions options;
  options.starts = tuning.study.starts;
  options.observations = training.observations();
  std::vector<std::size_t> profiled;
  for (std::size_t k = 0; k < out.parameters.size(); ++k) {
    if (out.parameters[k].profile) profiled.push_back(k);
  }
  ProfiledFit found = fit_through_profiles(out.searched, residuals, options, profiled, profile_points);
  out.fit = std::move(found.fit);
  out.profiles = std::move(found.profiles);
  out.notes = notes_of(out);
  return out;
}

}  // namespace touchstone::compare
