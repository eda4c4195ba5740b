// What a contact model must offer to be judged: a step that is timed, and an answer that is compared.
#pragma once

#include "compare/model/advice.h"
#include "fast/run/run.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"
#include "scene/output/figures.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::compare {

/// Models of a family have one colour in the plots.
enum class ModelFamily {
  paper,       ///< the paper's skeleton with its own law
  area_aware,  ///< the same skeleton with another law
  compliance,  ///< precomputed linear compliance with a contact solve
  response,    ///< a half space in closed form and the body's precomputed response
  simulator,   ///< another simulator's deformable body
  reference,   ///< the reference's levels
  other,
};

/// Why a model cannot answer; what() completes "absent: ".
class Unavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Times of steps from an earlier run, for a solver that stores its results.
struct KnownSteps {
  double total_s = 0.0;
  int count = 0;
};

/// A contact model, set up for one scene.
class ContactModel {
 public:
  virtual ~ContactModel() = default;

  /// Moves the tool to a pose and computes force and shape. This is what is timed.
  /// A model that only answers has known_steps() instead.
  virtual void step(const scene::Pose& pose) = 0;

  /// Fills in forces, displacements and what else the model computes. The instants hold time, pose and depth, in the
  /// order of the scene's track, which begins anew with every call.
  /// @throws Unavailable
  virtual void answer(scene::Answer& asked) = 0;

  [[nodiscard]] virtual int size() const = 0;  ///< surface triangles, or unknowns
  /// Of model and state; absent if unknown.
  [[nodiscard]] virtual std::optional<double> memory_bytes() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<KnownSteps> known_steps() const { return std::nullopt; }
  /// A remark for comparing the model; may be empty.
  [[nodiscard]] virtual std::string note() const { return {}; }
  /// Faults of the last answer(); empty if there were none.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  /// Median time of a step in the last answer() [us]; absent if it was not measured.
  [[nodiscard]] virtual std::optional<double> step_p50_us() const { return std::nullopt; }
  /// Further figures of the last answer(), by keys of summary.json.
  [[nodiscard]] virtual scene::Figures figures() const { return {}; }
  /// The scene's whole track with everything that the fast model records, for pages about that model.
  /// Nothing from any other.
  [[nodiscard]] virtual std::optional<fast::Run> track() { return std::nullopt; }
};

/// A model's forces and shapes over one scene's track, with other constants from call to call: what a fit needs.
class ModelReplay {
 public:
  /// Gets a place among the instants asked for and the displacement of all rest points [m].
  using Visit = std::function<void(std::size_t, const Eigen::Matrix3Xd&)>;

  virtual ~ModelReplay() = default;
  /// Total force on the tool at every instant of the track [N].
  /// @param scene  the set-up's, with other constants
  [[nodiscard]] virtual std::vector<scene::Vec3> forces_n(const scene::Scene& scene) = 0;
  /// @param scene     its constants of the force are those of the last call of forces_n(), which must have been one
  /// @param instants  in rising order
  virtual void displacements(const scene::Scene& scene, std::span<const std::size_t> instants, const Visit& visit) = 0;
};

/// Says one line about what takes long; may be empty.
using Say = std::function<void(const std::string&)>;

/// From a scene to the one that a model is set up for.
using SceneChange = std::function<scene::Scene(scene::Scene)>;

/// The model with some of its parts switched off.
struct ModelParts {
  std::string key;  ///< of summary.json
  SceneChange change;
};

/// What a model says of itself where it is tuned and on the page of a comparison. Which of its constants can be tuned
/// is a column of the table of keys (scene/input/fields.h).
struct ModelAccount {
  std::string name{};  ///< in sentences, "corrected Duffing"; empty: the entry's
  /// Clauses of the findings on the shape, each with its punctuation: what moves the surface away from the contact, and
  /// on faces that nothing touches.
  std::string far_shape{}, untouched_faces{};
  /// Their effect on the shape error, and the sentence on it, in which {0} is that of the first.
  std::vector<ModelParts> parts{};
  std::string parts_sentence{};
  /// The likely cause of the force error, as far as the scene's own numbers show it.
  std::function<Reason(const scene::Scene&, const Errors&)> cause{};
  std::function<void(Advice&)> advise{};
};

/// A model by name: what the registry holds.
struct ModelEntry {
  std::string name;      ///< "corrected skeleton, 4k triangles"
  std::string key;       ///< of summary.json: "corrected-4k"
  std::string label{};   ///< short, for the plot
  std::string method{};  ///< law and skeleton, "Duffing, published"; empty: the name says it
  ModelFamily family = ModelFamily::other;
  /// Computes what set_up() reads from the store and does not find there. Empty: it reads nothing.
  std::function<void(const scene::Scene&, const Say&)> prepare{};
  /// @throws Unavailable
  std::function<std::unique_ptr<ContactModel>(const scene::Scene&)> set_up{};
  /// A faster way to repeat set_up() and answer() with other constants. Empty: there is none.
  std::function<std::unique_ptr<ModelReplay>(const scene::Scene&)> replay{};
  ModelAccount account{};
  bool gives_force = true;
  bool own = false;                ///< the model that a comparison's page is about
  bool finest_reference = false;   ///< the reference's finest level, by which all are judged
  std::optional<int> triangles{};  ///< of the surface it is judged on; absent: the scene's
  std::string absent{};            ///< why the model is not available; then set_up is not called
};

/// The entry, for a changed scene.
[[nodiscard]] inline ModelEntry changed(ModelEntry entry, const SceneChange& change) {
  entry.set_up = [set_up = std::move(entry.set_up), change](const scene::Scene& scene) {
    return set_up(change(scene));
  };
  entry.prepare = {};
  entry.replay = {};
  return entry;
}

}  // namespace touchstone::compare
