// What a contact model must offer to be judged: a step that is timed, and an answer that is compared.
#pragma once

#include "scene/model/answer.h"
#include "scene/model/scene.h"

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Models of a family have one colour in the plots.
enum class ModelFamily {
  paper,       ///< the paper's skeleton with its own law
  area_aware,  ///< the same skeleton with the area-aware law
  compliance,  ///< precomputed linear compliance with a contact solve
  peer,        ///< another simulator's deformable body
  reference,   ///< the reference's levels
  other,
};

/// Why a model cannot answer; what() completes "absent: ".
class Unavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What steps took that were made before, such as a solver's that keeps its results.
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
  /// Model and state; absent where the model does not know.
  [[nodiscard]] virtual std::optional<double> memory_bytes() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<KnownSteps> known_steps() const { return std::nullopt; }
  /// What a reader must know to compare the model; may be empty.
  [[nodiscard]] virtual std::string note() const { return {}; }
  /// What went wrong while it answered; empty when nothing did.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
};

/// A model by name: what the registry holds.
struct ModelEntry {
  std::string name;     ///< "corrected skeleton, 4k triangles"
  std::string key;      ///< of summary.json: "corrected-4k"
  std::string label{};  ///< short, for the plot
  ModelFamily family = ModelFamily::other;
  /// @throws Unavailable
  std::function<std::unique_ptr<ContactModel>(const scene::Scene&)> set_up{};
  bool gives_force = true;
  bool yardstick = false;          ///< the reference's finest answer, which all are compared with
  std::optional<int> triangles{};  ///< of the surface it is judged on; absent: the scene's
  std::string absent{};            ///< why there is no such model here; then set_up is not called
};

}  // namespace touchstone::compare
