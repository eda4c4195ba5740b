// Runs CalculiX on an exported deck and reads its answer.
#pragma once

#include "reference/calculix/deck.h"
#include "scene/base/frames.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Results of CalculiX at the end of one step of a deck, of the whole body in the world frame.
struct CalculixStep {
  scene::Vec3 force_n = scene::Vec3::Zero();  ///< on the tool
  Eigen::Matrix3Xd displacement_m;            ///< one column per node of Deck::surface_nodes
};

/// Reads a .dat file: as many steps as are complete in it, none when there is no such file.
[[nodiscard]] std::vector<CalculixStep> read_calculix(const std::filesystem::path& dat, const reference::Deck& deck);

/// Largest length of a column.
[[nodiscard]] inline double longest_m(const Eigen::Matrix3Xd& vectors_m) {
  return vectors_m.colwise().norm().maxCoeff();
}

struct CalculixRun {
  std::vector<CalculixStep> steps;  ///< fewer than the deck's when it did not converge
  double wall_s = 0.0, cpu_s = 0.0;
};

/// Runs `ccx` on folder/name.inp, its text in folder/name.log, on one thread: on two, 2.20 adds up in another order
/// each time, and a deck that converges ended without an answer in two runs of ten.
/// @throws scene::InputError when there is no such program
[[nodiscard]] CalculixRun run_calculix(const std::filesystem::path& folder, const std::string& name,
                                       const reference::Deck& deck);

}  // namespace touchstone::compare
