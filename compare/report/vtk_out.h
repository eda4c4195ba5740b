// The moved surfaces of both sides for ParaView: the rest surface with displacements as point arrays.
#pragma once

#include "compare/errors/errors.h"
#include "fast/run/run.h"
#include "reference/run/inside.h"
#include "reference/solver.h"

#include <filesystem>

namespace touchstone::compare {

/// Writes surface_0000.vtp ... (one per instant, binary, zlib) and surface.pvd, which gives each its time.
/// Points are the rest points; "Warp By Vector" with displacement_fast_m or displacement_reference_m shows a side.
/// Point arrays: displacement_fast_m, displacement_reference_m, displacement_error_m (fast - reference),
/// displacement_error_magnitude_m, displacement_reference_uncertainty_m, traction_reference_pa (of the tool on the
/// body, per current area), traction_reference_uncertainty_pa, normal_fast (current), region_id_fast and
/// region_id_reference (contact region touched, -1 for none). Surfaces left by an earlier, longer run are removed.
/// @throws std::filesystem::filesystem_error
void write_surfaces(const std::filesystem::path& folder, const fast::Run& run, const reference::Result& result,
                    const Errors& errors);

/// Writes the tool at its pose of each instant: tool_0000.vtp ... and tool.pvd with the same times. Of its own file,
/// so that surface.pvd stays one body to be warped and coloured: opened beside it in ParaView, both follow one clock.
/// An analytic tool is drawn with some 3000 triangles, a mesh tool as it is.
void write_tool(const std::filesystem::path& folder, const scene::Tool& tool, const scene::Instants& instants);

/// The same for one side alone: displacement_m and the current normal.
void write_fast_surfaces(const std::filesystem::path& folder, const fast::Run& run);

/// displacement_m and displacement_uncertainty_m.
/// @param surface the rest points the result was asked for
void write_reference_surfaces(const std::filesystem::path& folder, const scene::Surface& surface,
                              const reference::Result& result);

/// Writes the inside of the reference's body at each instant: volume_0000.vtu ... and volume.pvd, see
/// reference::Inside::volume_file.
void write_volume(const std::filesystem::path& folder, const scene::Instants& instants,
                  const reference::Inside& inside);

}  // namespace touchstone::compare
