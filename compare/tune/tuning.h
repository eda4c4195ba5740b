// The data of a tuning: contacts with the reference's results, fits, and the tuned models' results on every contact.
#pragma once

#include "compare/errors/errors.h"
#include "compare/input/tuning_study.h"
#include "compare/model/model.h"
#include "compare/tune/fit.h"
#include "reference/solver.h"

#include <functional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Solves a scene, or reads its result back.
using SolveReference = std::function<reference::Result(const scene::Scene&, const scene::Surface&)>;

/// One contact with the reference's answer at the instants that count.
struct TuningData {
  TuningContact contact;
  reference::Result result;           ///< only those instants
  std::vector<std::size_t> instants;  ///< their indices in the whole track
  scene::Surface surface;

  [[nodiscard]] bool held_out() const noexcept { return !contact.differs.empty(); }
};

/// Fit of one stage.
struct StageFit {
  TuningStage stage = TuningStage::force;
  std::vector<TuningParameter> parameters;
  std::vector<FitParameter> searched;  ///< the same, as the fit takes them
  Fit fit;
  std::vector<Profile> profiles;
  std::vector<std::string> notes;  ///< what the data do not determine, a sentence each
};

/// Error of the model at one instant, and where it occurs.
struct RegimePoint {
  double depth_m = 0.0;
  double depth_over_radius = 0.0;  ///< of the tool where it is round, else of the reference's contact disc
  double area_m2 = 0.0;            ///< of the reference's contact
  double place_m = 0.0;            ///< from the nearest training contact, straight, on the rest surface
  double force_error_rel = 0.0;    ///< |F_f - F_r| / |F_r|
};

/// The tuned model on one contact.
struct TuningOutcome {
  std::size_t data = 0;             ///< index into Tuning::data
  Errors errors;                    ///< at the instants that count
  std::vector<RegimePoint> regime;  ///< deep instants
};

/// One formulation and law, tuned.
struct TunedModel {
  scene::Formulation formulation = scene::Formulation::corrected;
  scene::ContactLaw law = scene::ContactLaw::duffing;
  ModelEntry entry;
  std::vector<StageFit> stages;
  std::vector<TuningOutcome> outcomes;  ///< in the order of the data
  /// Shape error on the first training contact, over the instants that count as shape.rel_l2 is, with each of the
  /// entry's parts switched off and nothing fitted again: which shows the effect of each part.
  std::vector<double> shape_parts;
  std::vector<std::string> limits;  ///< what limits it on its held-out contacts, a sentence each

  [[nodiscard]] const std::string& name() const { return entry.account.name.empty() ? entry.name : entry.account.name; }
};

struct Tuning {
  TuningStudy study;
  std::vector<TuningData> data;  ///< training contacts first
  std::vector<TunedModel> models;
};

/// Solves a contact. @throws InputError when the reference is never in contact at an instant that counts
[[nodiscard]] TuningData tuning_data(const TuningContact& contact, const SolveReference& solve);

/// Writes values into a scene, as set_parameter.
void set_values(scene::Scene& scene, const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values);

/// A contact's scene with the model's formulation, law and values so far.
[[nodiscard]] scene::Scene tuned_scene(const scene::Scene& scene, const TunedModel& model);

}  // namespace touchstone::compare
