// Files about the inside of the body: probes.csv, and volume.pvd for ParaView.
#pragma once

#include "reference/run/inside.h"
#include "reference/run/result.h"
#include "scene/model/scene.h"

#include <filesystem>
#include <string>

namespace touchstone::compare {

/// Writes probes.csv where the scene has probes: one row per instant and probe, world frame, stress positive in
/// tension, pressure in compression, an unknown uncertainty nan. With `volume` also volume_0000.vtu ... and volume.pvd,
/// which gives each its time: the cells at rest with displacement_m, stress_.._pa, stress_von_mises_pa, pressure_pa and
/// J_minus_1. Files left by an earlier run are removed.
/// @returns lines for the terminal that say where they are; empty without any
/// @throws std::filesystem::filesystem_error, scene::InputError when the store has lost a solution
std::string write_inside(const std::filesystem::path& folder, const scene::Scene& scene,
                         const reference::Result& result, const reference::Inside& inside, bool volume);

}  // namespace touchstone::compare
