#include "scene/mesh/mesh_checks.h"

#include "scene/base/index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace touchstone::scene {
namespace {

using Triangle = std::array<std::int32_t, 3>;

const Vec3& point(const RawMesh& mesh, std::int32_t i) { return nth(mesh.points, i); }

double diagonal(const std::vector<Vec3>& points) {
  Vec3 lower = points.front(), upper = points.front();
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return (upper - lower).norm();
}

struct Cell {
  std::array<std::int64_t, 3> index;
  bool operator==(const Cell&) const = default;
};
struct CellHash {
  std::size_t operator()(const Cell& cell) const noexcept {
    std::uint64_t hash = 0;
    for (const std::int64_t i : cell.index)
      hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15u + (hash >> 29);
    return hash;
  }
};

/// For every point the first point at the same place.
std::vector<std::int32_t> first_at_same_place(const std::vector<Vec3>& points) {
  const double tolerance = 1e-9 * diagonal(points);
  // Cells wide enough that a point's neighbours are in at most eight of them.
  const double width = std::max(4.0 * tolerance, 1e-300);
  const Vec3 origin = points.front();
  std::unordered_map<Cell, std::vector<std::int32_t>, CellHash> cells;
  std::vector<std::int32_t> first(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i] - origin;
    std::array<std::array<std::int64_t, 2>, 3> range;
    for (int axis = 0; axis < 3; ++axis) {
      nth(range, axis) = {std::llround(std::floor((p[axis] - tolerance) / width)),
                          std::llround(std::floor((p[axis] + tolerance) / width))};
    }
    std::int32_t same = static_cast<std::int32_t>(i);
    for (std::int64_t x = range[0][0]; x <= range[0][1]; ++x) {
      for (std::int64_t y = range[1][0]; y <= range[1][1]; ++y) {
        for (std::int64_t z = range[2][0]; z <= range[2][1]; ++z) {
          const auto cell = cells.find({{x, y, z}});
          if (cell == cells.end()) continue;
          for (const std::int32_t other : cell->second) {
            if ((nth(points, other) - points[i]).norm() <= tolerance) same = std::min(same, other);
          }
        }
      }
    }
    first[i] = same;
    if (same != static_cast<std::int32_t>(i)) continue;
    Cell home;
    for (int axis = 0; axis < 3; ++axis) {
      nth(home.index, axis) = std::llround(std::floor(p[axis] / width));
    }
    cells[home].push_back(same);
  }
  return first;
}

using Edge = std::pair<std::int32_t, std::int32_t>;

Edge edge_between(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

std::string edge_text(const RawMesh& mesh, const Edge& edge) {
  return "the edge from " + place_text(point(mesh, edge.first)) + " to " + place_text(point(mesh, edge.second));
}

double six_volumes(const RawMesh& mesh, const Triangle& t, const Vec3& from) {
  return (point(mesh, t[0]) - from).dot((point(mesh, t[1]) - from).cross(point(mesh, t[2]) - from));
}

/// Solid angle of a piece as seen from a point, in full turns: 1 inside, 0 outside (van Oosterom, Strackee).
double winding(const RawMesh& mesh, const MeshPiece& piece, const Vec3& from) {
  double angle = 0.0;
  for (const std::size_t t : piece.triangles) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3 a = point(mesh, i) - from, b = point(mesh, j) - from, c = point(mesh, k) - from;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

}  // namespace

std::string place_text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z()); }

RawMesh welded(const RawMesh& mesh) {
  RawMesh out;
  if (mesh.points.empty()) return out;
  const std::vector<std::int32_t> first = first_at_same_place(mesh.points);
  std::vector<std::int32_t> number(mesh.points.size(), -1);
  for (const Triangle& raw : mesh.triangles) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = nth(first, raw[k]);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const Vec3 area = (point(mesh, t[1]) - point(mesh, t[0])).cross(point(mesh, t[2]) - point(mesh, t[0]));
    if (area.squaredNorm() == 0.0) continue;
    for (std::int32_t& corner : t) {
      std::int32_t& place = nth(number, corner);
      if (place < 0) {
        place = static_cast<std::int32_t>(out.points.size());
        out.points.push_back(point(mesh, corner));
      }
      corner = place;
    }
    out.triangles.push_back(t);
  }
  return out;
}

std::optional<std::string> orient_outwards(RawMesh& mesh, std::vector<MeshPiece>& pieces) {
  if (mesh.triangles.empty()) return "the mesh holds no triangle with an area";
  std::map<Edge, std::vector<std::size_t>> on_edge;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      on_edge[edge_between(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])].push_back(t);
    }
  }
  for (const auto& [edge, triangles] : on_edge) {
    if (triangles.size() == 1) return "the surface is open: " + edge_text(mesh, edge) + " has one triangle";
    if (triangles.size() > 2) {
      return edge_text(mesh, edge) + " has " + std::to_string(triangles.size()) +
             " triangles; expected 2 on a closed surface";
    }
  }
  std::vector<bool> seen(mesh.triangles.size(), false);
  for (std::size_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed]) continue;
    MeshPiece piece{{seed}, 0.0};
    seen[seed] = true;
    for (std::size_t next = 0; next < piece.triangles.size(); ++next) {
      const std::size_t t = piece.triangles[next];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
        const auto& both = on_edge[edge_between(a, b)];
        const std::size_t other = both[0] == t ? both[1] : both[0];
        Triangle& n = mesh.triangles[other];
        // Orientations agree if the neighbour traverses the edge in the opposite direction.
        const bool alike = (n[0] == b && n[1] == a) || (n[1] == b && n[2] == a) || (n[2] == b && n[0] == a);
        if (!seen[other]) {
          if (!alike) std::swap(n[1], n[2]);
          seen[other] = true;
          piece.triangles.push_back(other);
        } else if (!alike) {
          return "the surface is not orientable: its normals cannot all point outwards at " +
                 edge_text(mesh, edge_between(a, b));
        }
      }
    }
    pieces.push_back(std::move(piece));
  }
  for (MeshPiece& piece : pieces) {
    const Vec3 from = point(mesh, mesh.triangles[piece.triangles.front()][0]);
    double area = 0.0, reach = 0.0;
    for (const std::size_t t : piece.triangles) {
      const auto& [a, b, c] = mesh.triangles[t];
      piece.volume += six_volumes(mesh, mesh.triangles[t], from) / 6.0;
      area += 0.5 * (point(mesh, b) - point(mesh, a)).cross(point(mesh, c) - point(mesh, a)).norm();
      reach = std::max(reach, (point(mesh, a) - from).norm());
    }
    if (std::abs(piece.volume) <= 1e-12 * area * reach) {
      return "the piece at " + place_text(from) + " encloses no volume";
    }
    if (piece.volume < 0.0) {
      for (const std::size_t t : piece.triangles) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      piece.volume = -piece.volume;
    }
  }
  return std::nullopt;
}

std::optional<Vec3> nested_piece(const RawMesh& mesh, const std::vector<MeshPiece>& pieces) {
  std::vector<Bounds> boxes;
  for (const MeshPiece& piece : pieces) {
    Bounds box{Vec3::Constant(INFINITY), Vec3::Constant(-INFINITY)};
    for (const std::size_t t : piece.triangles) {
      for (const std::int32_t i : mesh.triangles[t]) {
        box.lower_m = box.lower_m.cwiseMin(point(mesh, i));
        box.upper_m = box.upper_m.cwiseMax(point(mesh, i));
      }
    }
    boxes.push_back(box);
  }
  for (const MeshPiece& inner : pieces) {
    const Vec3 place = point(mesh, mesh.triangles[inner.triangles.front()][0]);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const MeshPiece& outer = pieces[i];
      const bool in_box =
          (boxes[i].lower_m.array() <= place.array()).all() && (place.array() <= boxes[i].upper_m.array()).all();
      if (in_box && inner.volume < outer.volume && winding(mesh, outer, place) > 0.5) return place;
    }
  }
  return std::nullopt;
}

}  // namespace touchstone::scene
