// Closed triangle meshes of rigid tools: reading, welding, orienting, refusing.
#pragma once

#include "scene/error.h"
#include "scene/frames.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace touchstone::scene {

/// A closed surface of triangles, counter-clockwise seen from outside, without duplicate or unused vertices. It may
/// have several closed pieces and need not be convex.
struct TriangleMesh {
  Eigen::Matrix3Xd points_m;  ///< one column per vertex
  std::vector<std::array<std::int32_t, 3>> triangles;

  [[nodiscard]] double area_m2() const;
  [[nodiscard]] double volume_m3() const;
  [[nodiscard]] Vec3 centroid_m() const;  ///< of the enclosed volume
  [[nodiscard]] Bounds bounds() const;
};

/// Reads STL (text or binary), OBJ or PLY (text or binary), by the file's ending; multiplies coordinates by unit_m,
/// welds duplicate vertices, drops triangles without area, turns every piece outwards. A mesh that is open, has an
/// edge with more than two triangles, cuts itself or holds a number that is not finite is refused.
/// @param faults takes what is wrong, with the file, the line or byte, and the place in the mesh
/// @returns nothing when there were faults
[[nodiscard]] std::optional<TriangleMesh> read_triangle_mesh(const std::filesystem::path& file, double unit_m,
                                                             std::vector<Fault>& faults);

/// Binary STL, coordinates divided by unit_m. @throws InputError when the file cannot be written
void write_stl(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m);

/// OBJ text with shared vertices, coordinates divided by unit_m and rounded to 1e-5 of that unit.
/// @throws InputError when the file cannot be written
void write_obj(const TriangleMesh& mesh, const std::filesystem::path& file, double unit_m);

}  // namespace touchstone::scene
