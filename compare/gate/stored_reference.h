// Reference results small enough to be committed, which accuracy gates compare with. A folder holds
//
//   reference.json   what it is of, how good it is, the command that makes it again, checksums of the other two
//   curve.csv        a row per instant: pose, forces, uncertainties, quality
//   surface.f32.z    displacement and its uncertainty of every rest point at every instant, in single precision
#pragma once

#include "reference/solver.h"
#include "scene/shape/surface.h"

#include <filesystem>
#include <stdexcept>
#include <string>

namespace touchstone::compare {

/// Stored data that cannot be compared with: missing, altered, or of another scene or method (stale).
class UnusableReference : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes the folder, making it where it is missing.
/// @param surface  whose points are the rest points of the result
/// @param command  that makes it again
/// @throws std::filesystem::filesystem_error
void store_reference(const std::filesystem::path& folder, const scene::Scene& scene, const scene::Surface& surface,
                     const reference::Result& result, const std::string& command);

/// Reads what store_reference() wrote for this scene and surface. Numbers of curve.csv come back exactly, displacements
/// to 6e-8 of their size. Of the levels only mesh, unknowns and times are there, of the sensitivities nothing.
/// @throws UnusableReference
[[nodiscard]] reference::Result stored_reference(const std::filesystem::path& folder, const scene::Scene& scene,
                                                 const scene::Surface& surface);

}  // namespace touchstone::compare
