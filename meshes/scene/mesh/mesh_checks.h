// From loose triangles to a closed surface: welding, orienting, and what makes a mesh no surface of a solid.
#pragma once

#include "scene/mesh/mesh_formats.h"

#include <optional>
#include <string>

namespace touchstone::scene {

/// Makes one vertex of those that lie within 1e-9 of the bounding box's diagonal of each other, drops triangles without
/// area and vertices without triangles. Vertices keep the order in which triangles first name them.
[[nodiscard]] RawMesh welded(const RawMesh& mesh);

/// A closed piece of a mesh.
struct MeshPiece {
  std::vector<std::size_t> triangles;
  double volume = 0.0;
};

/// Orients the triangles of every piece consistently, then outwards, and lists the pieces.
/// @returns what keeps the mesh from bounding solids, in words with places in the mesh's unit; nothing when all is well
[[nodiscard]] std::optional<std::string> orient_outwards(RawMesh& mesh, std::vector<MeshPiece>& pieces);

/// A place of a piece that lies inside another one, as the wall of a cavity would.
[[nodiscard]] std::optional<Vec3> nested_piece(const RawMesh& mesh, const std::vector<MeshPiece>& pieces);

/// Two triangles without a common vertex that cut or touch each other; a place where they do, in the mesh's unit.
/// @param pairs_max  pairs of triangles looked at before it gives up: long thin triangles side by side have many.
/// @throws TooManyPairs
[[nodiscard]] std::optional<Vec3> self_intersection(const RawMesh& mesh, std::size_t pairs_max);

struct TooManyPairs {};

/// Whether the mesh bounds one convex solid, except for dents no deeper than the tolerance: of every triangle some
/// plane leaves all vertices on its inner side, or no further out than the tolerance, and no corner of the triangle
/// further in than that. So no place of the surface lies deeper than the tolerance below the convex hull. Numbers
/// rounded by up to a quarter of the tolerance never make a convex mesh fail.
/// @param mesh closed, turned outwards; @param tolerance above zero, in the mesh's unit
[[nodiscard]] bool convex(const RawMesh& mesh, double tolerance);

/// "(x, y, z)" with six digits.
[[nodiscard]] std::string place_text(const Vec3& p);

}  // namespace touchstone::scene
