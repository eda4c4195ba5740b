// Tuning: the fast model's free numbers fitted to the reference on training contacts and judged on contacts that the
// fit never saw. The force does not depend on the shape's parameters, so it is fitted first, then the shape with it.
#pragma once

#include "compare/errors/errors.h"
#include "compare/input/tuning_study.h"
#include "compare/tune/fit.h"
#include "fast/run/run.h"
#include "reference/solver.h"
#include "scene/output/results.h"

#include <filesystem>
#include <functional>
#include <optional>
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
  std::size_t data = 0;  ///< index into Tuning::data
  fast::Run run;         ///< at the instants that count
  Errors errors;
  std::vector<RegimePoint> regime;  ///< deep instants
};

/// Shape error on the first training contact, over the instants that count as shape.rel_l2 is, with parts of the tuned
/// model switched off and nothing fitted again: what each part is good for.
struct ShapeParts {
  double whole = 0.0;
  double without_local_factor = 0.0;  ///< C_n = 0
  double anchors_at_rest = 0.0;       ///< beams too stiff to move them
  double hat_alone = 0.0;             ///< neither: the contact point spread over its patches
};

/// One formulation and law, tuned.
struct TunedModel {
  scene::Formulation formulation = scene::Formulation::corrected;
  scene::ContactLaw law = scene::ContactLaw::duffing;
  std::vector<StageFit> stages;
  std::vector<TuningOutcome> outcomes;  ///< in the order of the data
  ShapeParts shape_parts;
  std::vector<std::string> limits;  ///< what limits it on its held-out contacts, a sentence each

  [[nodiscard]] std::string name() const;  ///< "corrected area-aware"
  [[nodiscard]] std::string key() const;   ///< "corrected-area_aware", for files and figures
};

struct Tuning {
  TuningStudy study;
  std::vector<TuningData> data;  ///< training contacts first
  std::vector<TunedModel> models;
};

/// Solves a contact. @throws InputError when the reference is never in contact at an instant that counts
[[nodiscard]] TuningData tuning_data(const TuningContact& contact, const SolveReference& solve);

/// Keeps of an answer over a contact's whole track the instants that count. @param instants  of TuningData
void keep_instants(scene::Answer& answer, const std::vector<std::size_t>& instants);

/// A contact's scene with the model's formulation, law and values so far.
[[nodiscard]] scene::Scene tuned_scene(const scene::Scene& scene, const TunedModel& model);

/// @param say  called with one line about what begins; may be empty
/// @throws what `solve` throws, std::runtime_error when the model has no answer at any start of a fit
[[nodiscard]] Tuning tune(const TuningStudy& study, const SolveReference& solve,
                          const std::function<void(const std::string&)>& say = {});

/// Keys of summary.json: of a comparison under training. and held_out., the worst of the contacts, with
/// `training.<contact>.` and `held_out.<contact>.` for each; the parameters and what is known of them.
/// All of the first model; of every model again behind its name.
[[nodiscard]] scene::Figures tuning_figures(const Tuning& tuning);

/// The model's values as a file that a scene can include.
[[nodiscard]] std::string parameters_toml(const Tuning& tuning, const TunedModel& model);

/// parameters.toml of the first model, `parameters-<formulation>-<law>.toml` of each, summary.json, curve.csv,
/// report.html and manifest.json. @throws std::filesystem::filesystem_error
void write_tuning(const std::filesystem::path& folder, const Tuning& tuning, const scene::Manifest& manifest);

}  // namespace touchstone::compare
