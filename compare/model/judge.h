// A model against the reference: its answer to one scene, the errors of that, and the rows of a table of models.
#pragma once

#include "compare/errors/errors.h"
#include "compare/model/registry.h"

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::compare {

/// The instants of a track without an answer, to be filled by a model.
/// @param surface  at rest, whose points are asked for
[[nodiscard]] scene::Answer unanswered(const scene::Surface& surface, const scene::Instants& instants);
[[nodiscard]] scene::Answer unanswered(const scene::Scene& scene);

/// Errors of a model's answer; those of the force are absent where the model gives none.
/// @throws std::logic_error when the sides do not belong together
[[nodiscard]] Errors errors_of(const ModelEntry& entry, const scene::Scene& scene, const scene::Answer& answer,
                               const std::vector<scene::ReferenceInstant>& reference);

/// Lets a model answer at the reference's instants. @throws Unavailable
[[nodiscard]] Errors judge(const ModelEntry& entry, ContactModel& model, const scene::Scene& scene,
                           const scene::Surface& surface, const std::vector<scene::ReferenceInstant>& reference);

/// One model's row. Errors are those of Errors, with the reference's uncertainty.
struct JudgedModel {
  std::string key{};     ///< in summary.json: `model.<key>.force.nrmse` and so on
  std::string name{};    ///< "paper as printed"
  std::string method{};  ///< law and skeleton, "Duffing, published"
  Measure force_nrmse{}, shape_rel_l2{};
  double step_p50_us = std::numeric_limits<double>::quiet_NaN();  ///< over the ticks of the track
  Measure pressure_rel_l2{}, pressure_peak_rel{};                 ///< of a model that gives tractions
  std::string trouble{};                                          ///< see ContactModel
  std::string absent{};                                           ///< why there are no errors; else empty
};

/// Models that are judged on one scene.
struct Contenders {
  scene::Scene scene;  ///< as in its file; models with other constants change it themselves
  std::vector<ModelEntry> models;
};

/// Those of every comparison, then those of these keys. @throws scene::InputError for a key that is none
/// @param say  as of ModelRequest
[[nodiscard]] Contenders contenders(const scene::Scene& scene,
                                    const std::vector<std::filesystem::path>& parameters = {},
                                    const std::vector<std::string>& keys = {},
                                    const std::function<void(const std::string&)>& say = {});

/// Judges every model by the same answer of the reference.
/// @param own  of the models marked as such, found already: errors, time and trouble
[[nodiscard]] std::vector<JudgedModel> judge_models(const Contenders& contenders, const scene::Surface& surface,
                                                    const std::vector<scene::ReferenceInstant>& reference,
                                                    const JudgedModel& own);

}  // namespace touchstone::compare
