// The choices that determine a list of models.
#pragma once

#include "compare/model/model.h"
#include "reference/solver.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// The scene, contacts and options from which models are chosen.
struct ModelRequest {
  const scene::Scene& scene;
  std::vector<scene::Scene> contacts{};             ///< that they are judged on; empty: the scene
  std::vector<std::filesystem::path> parameters{};  ///< files of tuned constants, each one more model
  bool quick = false;                               ///< small sizes
  std::function<int()> reference_levels{};          ///< that every contact's reference has; empty: it is no model here
  /// The reference of a contact on a number of levels.
  std::function<reference::Result(const scene::Scene&, const scene::Surface&, int levels)> solve{};
  Say say{};
};

/// Some models of one kind.
using ModelList = std::vector<ModelEntry> (*)(const ModelRequest&);

}  // namespace touchstone::compare
