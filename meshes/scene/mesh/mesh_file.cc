#include "scene/mesh/mesh_file.h"

#include "scene/base/input.h"
#include "scene/base/text.h"
#include "scene/mesh/mesh_checks.h"

#include <optional>
#include <string>
#include <utility>

namespace touchstone::scene {
namespace {

/// A mesh with its file's content: who holds the mesh can ask for the content.
struct MeshOfFile {
  std::string content;
  void operator()(const TriangleMesh* mesh) const { delete mesh; }
};

std::optional<TriangleMesh> checked_mesh(const std::string& content, const std::filesystem::path& file, double unit_m,
                                         std::vector<Fault>& faults) {
  const auto refuse = [&](const std::string& message) {
    faults.push_back({file.string(), 0, 0, message});
    return std::nullopt;
  };
  RawMesh raw = read_mesh(content, file);
  if (raw.triangles.size() > mesh_triangles_max) {
    return refuse("the mesh has " + std::to_string(raw.triangles.size()) + " triangles; expected at most " +
                  std::to_string(mesh_triangles_max));
  }
  for (const Vec3& p : raw.points) {
    if (!(p.cwiseAbs().maxCoeff() * unit_m <= mesh_reach_max_m)) {
      return refuse("the vertex at " + place_text(p) + " is " + number_text(p.cwiseAbs().maxCoeff() * unit_m) +
                    " m from the origin along an axis; expected at most " + number_text(mesh_reach_max_m) +
                    " m (tool.unit)");
    }
  }
  raw = welded(raw);
  // Faults give positions in the file's own unit, as its author sees them.
  std::vector<MeshPiece> pieces;
  if (const auto fault = orient_outwards(raw, pieces)) return refuse(*fault);
  if (pieces.size() > mesh_pieces_max) {
    return refuse("the mesh has " + std::to_string(pieces.size()) + " separate pieces; expected at most " +
                  std::to_string(mesh_pieces_max));
  }
  try {
    // A mesh of well-shaped triangles has some ten pairs for each.
    const std::size_t pairs_max = 4'000'000 + 20 * raw.triangles.size();
    if (const auto place = self_intersection(raw, pairs_max)) {
      return refuse("the surface cuts or touches itself near " + place_text(*place));
    }
  } catch (const TooManyPairs&) {
    return refuse(
        "the mesh has too many long thin triangles side by side to check for self-intersection; expected "
        "triangles with more equal sides");
  }
  if (const auto place = nested_piece(raw, pieces)) {
    return refuse("the piece at " + place_text(*place) +
                  " lies inside another; cavities are not supported, leave it out");
  }
  TriangleMesh mesh;
  mesh.points_m.resize(3, static_cast<Eigen::Index>(raw.points.size()));
  for (std::size_t i = 0; i < raw.points.size(); ++i) {
    mesh.points_m.col(static_cast<Eigen::Index>(i)) = unit_m * raw.points[i];
  }
  const Bounds bounds = mesh.bounds();
  mesh.convex = convex(raw, convex_tolerance_rel * (bounds.upper_m - bounds.lower_m).norm() / unit_m);
  mesh.triangles = std::move(raw.triangles);
  return mesh;
}

}  // namespace

std::shared_ptr<const TriangleMesh> mesh_of_file(std::string content, const std::filesystem::path& file, double unit_m,
                                                 std::vector<Fault>& faults) {
  try {
    std::optional<TriangleMesh> mesh = checked_mesh(content, file, unit_m, faults);
    if (!mesh) return nullptr;
    return {new TriangleMesh(*std::move(mesh)), MeshOfFile{std::move(content)}};
  } catch (const InputError& error) {
    faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    return nullptr;
  }
}

std::optional<TriangleMesh> read_triangle_mesh(const std::filesystem::path& file, double unit_m,
                                               std::vector<Fault>& faults) {
  Input input = read_input(file, mesh_input);
  if (!input.fault.empty()) {
    faults.push_back({file.string(), 0, 0, "cannot read the mesh: " + input.fault});
    return std::nullopt;
  }
  const std::shared_ptr<const TriangleMesh> mesh = mesh_of_file(std::move(input.bytes), file, unit_m, faults);
  return mesh ? std::optional(*mesh) : std::nullopt;
}

const std::string* content_of_file(const std::shared_ptr<const TriangleMesh>& mesh) {
  const auto* kept = mesh ? std::get_deleter<MeshOfFile>(mesh) : nullptr;
  return kept != nullptr ? &kept->content : nullptr;
}

}  // namespace touchstone::scene
