// A mesh together with the content of the file it was read from, which result folders keep a copy of.
#pragma once

#include "scene/base/error.h"
#include "scene/mesh/triangle_mesh.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::scene {

/// A mesh tool is no larger than the other tools, and checking one is a matter of seconds.
inline constexpr double mesh_reach_max_m = 10.0;  ///< of every coordinate
inline constexpr std::size_t mesh_triangles_max = 500'000, mesh_pieces_max = 1000;

/// Reads STL (text or binary), OBJ or PLY (text or binary), by the file's ending; multiplies coordinates by unit_m,
/// welds duplicate vertices, drops triangles without area, turns every piece outwards, determines whether it is convex.
/// A mesh that is open, has an edge with more than two triangles, cuts itself or holds a number that is not finite is
/// refused.
/// @param faults takes what is wrong, with the file, the line or byte, and the place in the mesh
/// @returns nothing when there were faults
[[nodiscard]] std::optional<TriangleMesh> read_triangle_mesh(const std::filesystem::path& file, double unit_m,
                                                             std::vector<Fault>& faults);

/// As read_triangle_mesh(). @param file  the content is of; @returns null when there were faults
[[nodiscard]] std::shared_ptr<const TriangleMesh> mesh_of_file(std::string content, const std::filesystem::path& file,
                                                               double unit_m, std::vector<Fault>& faults);

/// The file's content as it was when the mesh was read, even if the file has changed since; null for a mesh that
/// mesh_of_file() did not make. It exists as long as the mesh.
[[nodiscard]] const std::string* content_of_file(const std::shared_ptr<const TriangleMesh>& mesh);

}  // namespace touchstone::scene
