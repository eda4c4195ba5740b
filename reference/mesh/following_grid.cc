#include "reference/mesh/following_grid.h"

#include "reference/discretisation/shape.h"
#include "scene/base/in_space.h"
#include "scene/model/solid_kinds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

namespace touchstone::reference {
namespace {

template <int dim>
using Point = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Grid = FollowingGrid<dim>;

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// Weight of a corner of the unit cell at a point in it.
double weight_of(int corner, const double* xi, int directions) {
  double weight = 1.0;
  for (int d = 0; d < directions; ++d) weight *= (corner >> d & 1) != 0 ? xi[d] : 1.0 - xi[d];
  return weight;
}

template <int dim>
Point<dim> onto(const scene::Shape& shape, const Point<dim>& x_m) {
  scene::Vec3 foot_m = shape.query(scene::in_space<dim>(x_m)).point_m;
  if constexpr (dim == 3) {
    return foot_m;
  } else {
    return {foot_m.x(), foot_m.z()};
  }
}

/// Corners of a cell's side: 2 * direction, + 1 for the upper one.
template <int dim>
typename Grid<dim>::Side side_of(const typename Grid<dim>::Corners& corners, int side) {
  typename Grid<dim>::Side result;
  int next = 0;
  for (int v = 0; v < 1 << dim; ++v) {
    if ((v >> side / 2 & 1) == side % 2) result[next++] = corners[v];
  }
  return result;
}

/// The place of a point of a cell, side or edge, as its corners tell: blended from all its sides, edges and corners
/// (W. J. Gordon, C. A. Hall, Int. J. Numer. Methods Eng. 7 (1973) 461-477).
template <int dim>
Point<dim> place_m(const Grid<dim>& grid, std::span<const int> corners, const double* xi, int directions) {
  const auto vertex = [&](std::size_t v) -> const typename Grid<dim>::Vertex& { return grid.vertices[corners[v]]; };
  if (directions == 0) return vertex(0).place_m;
  if (std::none_of(corners.begin(), corners.end(), [&](int v) { return grid.vertices[v].moved; })) {
    Point<dim> at = Point<dim>::Zero();
    for (std::size_t v = 0; v < corners.size(); ++v) {
      at += weight_of(static_cast<int>(v), xi, directions) * vertex(v).grid;
    }
    return grid.body.place_m(at);
  }
  Point<dim> sum_m = Point<dim>::Zero();
  // Per direction: at its lower end, its upper end, or free.
  for (int part = 0; part + 1 < power(3, directions); ++part) {
    std::array<int, 1 << dim> of_part;
    std::array<double, dim> rest;
    int free = 0, fixed_bits = 0, free_bits = 0, code = part;
    double weight = 1.0;
    for (int d = 0; d < directions; ++d, code /= 3) {
      if (code % 3 == 2) {
        free_bits |= 1 << d;
        rest[free++] = xi[d];
      } else {
        fixed_bits |= (code % 3) << d;
        weight *= code % 3 == 1 ? xi[d] : 1.0 - xi[d];
      }
    }
    if (weight == 0.0) continue;
    int count = 0;
    for (int v = 0; v < 1 << directions; ++v) {
      if ((v & ~free_bits) == fixed_bits) of_part[count++] = corners[v];
    }
    const double sign = (directions - free) % 2 == 1 ? 1.0 : -1.0;
    sum_m += sign * weight * place_m<dim>(grid, {of_part.data(), static_cast<std::size_t>(count)}, rest.data(), free);
  }
  const int surface = vertex(0).surface;
  const bool on_it = surface > 0 && std::all_of(corners.begin(), corners.end(),
                                                [&](int v) { return grid.vertices[v].surface == surface; });
  return on_it ? onto<dim>(*grid.shapes[surface - 1], sum_m) : sum_m;
}

/// Makes the grid, with the body's cells divided into some parts in each direction.
template <int dim>
class Maker {
 public:
  static constexpr int corner_count = 1 << dim;
  using Corners = typename Grid<dim>::Corners;
  using Side = typename Grid<dim>::Side;

  Maker(Grid<dim>& grid, int parts) : grid_(grid), parts_(parts) {}

  /// @returns whether it fits
  bool operator()() {
    divide();
    if (!choose() || !apart()) return false;
    pillow();
    smooth();
    measure();
    return regular();
  }

 private:
  /// What a vertex may not leave.
  struct Bound {
    bool fixed = false;
    std::array<bool, dim> in_plane{};  // where this coordinate is zero
  };

  void divide() {
    grid_.vertices.clear();
    grid_.cells.clear();
    std::map<std::array<long, dim>, int> numbers;
    const int row = parts_ + 1;
    for (const auto& cell : grid_.body.cells) {
      std::vector<int> own;
      for (int n = 0; n < power(row, dim); ++n) {
        Point<dim> xi, at = Point<dim>::Zero();
        for (int d = 0; d < dim; ++d) xi[d] = static_cast<double>(n / power(row, d) % row) / parts_;
        for (int v = 0; v < corner_count; ++v) at += weight_of(v, xi.data(), dim) * grid_.body.vertices[cell[v]];
        std::array<long, dim> key;
        for (int d = 0; d < dim; ++d) key[d] = std::lround(1e9 * at[d]);
        const auto [entry, fresh] = numbers.try_emplace(key, static_cast<int>(grid_.vertices.size()));
        if (fresh) grid_.vertices.push_back({grid_.body.place_m(at), at});
        own.push_back(entry->second);
      }
      for (int n = 0; n < power(parts_, dim); ++n) {
        auto& part = grid_.cells.emplace_back();
        for (int v = 0; v < corner_count; ++v) {
          int index = 0;
          for (int d = 0; d < dim; ++d) index += (n / power(parts_, d) % parts_ + (v >> d & 1)) * power(row, d);
          part.corners[v] = own[index];
        }
      }
    }
    bounds_.assign(grid_.vertices.size(), {});
    for (const auto& [key, owners] : sides()) {
      if (owners.size() > 1) continue;
      const Side side = side_of<dim>(grid_.cells[owners[0].first].corners, owners[0].second);
      const Boundary boundary = grid_.boundary(side);
      for (const int v : side) {
        if (boundary == Boundary::plane_x) {
          has_plane_[0] = bounds_[v].in_plane[0] = true;
        } else if (boundary == Boundary::plane_y) {
          has_plane_[1] = bounds_[v].in_plane[1] = true;
        } else {
          bounds_[v].fixed = true;
        }
      }
    }
    around();
  }

  /// Cells and their side's number, by the sorted corners.
  std::map<Side, std::vector<std::pair<int, int>>> sides() const {
    std::map<Side, std::vector<std::pair<int, int>>> result;
    for (int c = 0; c < static_cast<int>(grid_.cells.size()); ++c) {
      for (int f = 0; f < 2 * dim; ++f) {
        Side key = side_of<dim>(grid_.cells[c].corners, f);
        std::sort(key.begin(), key.end());
        result[key].emplace_back(c, f);
      }
    }
    return result;
  }

  void around() {
    around_.assign(grid_.vertices.size(), {});
    for (int c = 0; c < static_cast<int>(grid_.cells.size()); ++c) {
      for (const int v : grid_.cells[c].corners) around_[v].push_back(c);
    }
  }

  /// The share of a cell that lies inside an inclusion.
  double share_inside(const typename Grid<dim>::Cell& cell, const scene::Shape& shape) const {
    constexpr int samples = 4;
    int inside = 0;
    for (int n = 0; n < power(samples, dim); ++n) {
      Point<dim> xi;
      for (int d = 0; d < dim; ++d) xi[d] = (n / power(samples, d) % samples + 0.5) / samples;
      inside += shape.signed_distance_m(scene::in_space<dim>(grid_.place_m(cell.corners, xi))) < 0.0 ? 1 : 0;
    }
    return static_cast<double>(inside) / power(samples, dim);
  }

  /// Gives an inclusion the cells that are more than half inside. @returns whether each has some, or its mirror image
  bool choose() {
    shares_.assign(grid_.cells.size(), 0.0);
    std::set<int> found;
    for (std::size_t c = 0; c < grid_.cells.size(); ++c) {
      auto& cell = grid_.cells[c];
      double size_m = 0.0;
      for (const int v : cell.corners) {
        size_m = std::max(size_m, (grid_.vertices[v].place_m - grid_.vertices[cell.corners[0]].place_m).norm());
      }
      for (std::size_t k = 0; k < grid_.shapes.size(); ++k) {
        const Point<dim>& near_m = grid_.vertices[cell.corners[0]].place_m;
        if (grid_.shapes[k]->signed_distance_m(scene::in_space<dim>(near_m)) > 1.5 * size_m) continue;
        const double share = share_inside(cell, *grid_.shapes[k]);
        shares_[c] = std::max(shares_[c], share);
        if (share < 0.5) continue;
        cell.material = static_cast<int>(k) + 1;
        found.insert(cell.material);
      }
    }
    for (std::size_t k = 0; k < grid_.shapes.size(); ++k) {
      const scene::Vec3 upper_m = grid_.shapes[k]->bounds().upper_m;
      bool mirrored = false;  // only its image is in the mesh
      for (int d = 0; d < dim - 1; ++d) mirrored |= has_plane_[d] && upper_m[d] <= 0.0;
      if (!mirrored && !found.contains(static_cast<int>(k) + 1)) return false;
    }
    return !found.empty();
  }

  /// Whether the cells around a vertex of one kind hang together by sides.
  bool together(const std::vector<int>& cells) const {
    std::vector<int> reached;
    if (cells.empty()) return true;
    std::vector<int> left(cells.begin() + 1, cells.end());
    reached.push_back(cells[0]);
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const Corners& from = grid_.cells[reached[next]].corners;
      std::erase_if(left, [&](int c) {
        const Corners& to = grid_.cells[c].corners;
        const auto common = std::count_if(to.begin(), to.end(),
                                          [&](int v) { return std::find(from.begin(), from.end(), v) != from.end(); });
        if (common < corner_count / 2) return false;
        reached.push_back(c);
        return true;
      });
    }
    return left.empty();
  }

  /// Makes the sides between cells of two materials a closed surface by changing the cells that are nearest to half
  /// inside. @returns whether that surface has distance from the body's and from others
  bool apart() {
    std::set<int> changed;
    for (int v = 0; v < static_cast<int>(around_.size()); ++v) {
      std::vector<int> inside, outside;
      int material = 0;
      for (const int c : around_[v]) {
        const int own = grid_.cells[c].material;
        (own > 0 ? inside : outside).push_back(c);
        if (own == 0) continue;
        if (bounds_[v].fixed || (material > 0 && own != material)) return false;
        material = own;
      }
      if (together(inside) && together(outside)) continue;
      int best = -1;
      for (const int c : around_[v]) {
        if (changed.contains(c)) continue;
        if (best < 0 || std::abs(shares_[c] - 0.5) < std::abs(shares_[best] - 0.5)) best = c;
      }
      if (best < 0) return false;
      changed.insert(best);
      grid_.cells[best].material = grid_.cells[best].material > 0 ? 0 : material;
      v = -1;
    }
    return true;
  }

  void pillow() {
    struct Between {
      int inner, inner_side, outer, outer_side;
    };
    std::vector<Between> between;
    for (const auto& [key, owners] : sides()) {
      if (owners.size() < 2) continue;
      auto [a, b] = std::pair(owners[0], owners[1]);
      if (grid_.cells[a.first].material == 0) std::swap(a, b);
      if (grid_.cells[a.first].material == 0 || grid_.cells[b.first].material != 0) continue;
      between.push_back({a.first, a.second, b.first, b.second});
      for (const int v : key) grid_.vertices[v].surface = grid_.cells[a.first].material;
    }
    const auto middle_m = [&](int v, bool inside) {
      Point<dim> sum_m = Point<dim>::Zero();
      int count = 0;
      for (const int c : around_[v]) {
        if ((grid_.cells[c].material > 0) != inside) continue;
        for (const int corner : grid_.cells[c].corners) sum_m += grid_.vertices[corner].place_m;
        count += corner_count;
      }
      return Point<dim>(sum_m / count);
    };
    // A vertex's copies inside and outside, a third of the way to the middle of the cells there.
    const int before = static_cast<int>(grid_.vertices.size());
    std::vector<std::array<int, 2>> copies(before, {-1, -1});
    for (int v = 0; v < before; ++v) {
      if (grid_.vertices[v].surface == 0) continue;
      for (const int inside : {0, 1}) {
        auto copy = grid_.vertices[v];
        copy.surface = 0;
        copy.place_m += (middle_m(v, inside == 1) - copy.place_m) / 3.0;
        keep(copy.place_m, bounds_[v]);
        copies[v][inside] = static_cast<int>(grid_.vertices.size());
        grid_.vertices.push_back(copy);
        bounds_.push_back(bounds_[v]);
      }
    }
    std::vector<typename Grid<dim>::Cell> added;
    const auto add = [&](int c, int f, int inside) {
      const auto& cell = grid_.cells[c];
      auto& pillow = added.emplace_back();
      pillow.material = cell.material;
      for (int v = 0; v < corner_count; ++v) {
        const bool on_it = (v >> f / 2 & 1) == f % 2;
        pillow.corners[v] = on_it ? cell.corners[v] : copies[cell.corners[v ^ 1 << f / 2]][inside];
      }
    };
    for (const Between& one : between) {
      add(one.inner, one.inner_side, 1);
      add(one.outer, one.outer_side, 0);
    }
    for (auto& cell : grid_.cells) {
      for (int& v : cell.corners) {
        if (v < before && grid_.vertices[v].surface > 0) v = copies[v][cell.material > 0 ? 1 : 0];
      }
    }
    grid_.cells.insert(grid_.cells.end(), added.begin(), added.end());
    for (int v = 0; v < before; ++v) {
      auto& vertex = grid_.vertices[v];
      keep(vertex.place_m, bounds_[v]);
      if (vertex.surface > 0) vertex.place_m = onto<dim>(*grid_.shapes[vertex.surface - 1], vertex.place_m);
    }
    around();
    free_.assign(grid_.vertices.size(), 0);
    for (std::size_t v = 0; v < free_.size(); ++v) {
      free_[v] = grid_.vertices[v].surface > 0 || static_cast<int>(v) >= before ? 1 : 0;
    }
    constexpr int rings = 2;
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<char> wider = free_;
      for (const auto& cell : grid_.cells) {
        if (std::none_of(cell.corners.begin(), cell.corners.end(), [&](int v) { return free_[v] != 0; })) continue;
        for (const int v : cell.corners) wider[v] |= bounds_[v].fixed ? 0 : 1;
      }
      free_ = wider;
    }
    for (std::size_t v = 0; v < free_.size(); ++v) grid_.vertices[v].moved = free_[v] != 0;
  }

  static void keep(Point<dim>& place_m, const Bound& bound) {
    for (int d = 0; d < dim; ++d) {
      if (bound.in_plane[d]) place_m[d] = 0.0;
    }
  }

  /// How far the corners of the cells around a vertex are from those of a cube: the inverse of their mean ratio,
  /// squared, with a bound where a corner is turned inside out.
  /// @param flat  the bound's inverse, at a flat corner
  double badness(int vertex, double flat) const {
    double sum = 0.0;
    for (const int c : around_[vertex]) {
      const Corners& corners = grid_.cells[c].corners;
      for (int v = 0; v < corner_count; ++v) {
        Eigen::Matrix<double, dim, dim> edges_m;
        for (int d = 0; d < dim; ++d) {
          const double sign = (v >> d & 1) != 0 ? -1.0 : 1.0;
          edges_m.col(d) = sign * (grid_.vertices[corners[v ^ 1 << d]].place_m - grid_.vertices[corners[v]].place_m);
        }
        const double ratio = edges_m.determinant() / std::pow(edges_m.squaredNorm() / dim, 0.5 * dim);
        const double above = 0.5 * (ratio + std::sqrt(ratio * ratio + 4.0 * flat * flat));
        sum += 1.0 / (above * above);
      }
    }
    return sum;
  }

  /// Moves one vertex after the other by a pattern search, first with a low bound, which lets corners turn back.
  void smooth() {
    constexpr int sweeps = 30;
    for (const double flat : {0.5, 0.2, 0.05, 0.02}) {
      std::vector<double> step_m(grid_.vertices.size(), 0.0);
      for (std::size_t v = 0; v < step_m.size(); ++v) {
        if (free_[v]) step_m[v] = 0.3 * longest_edge_m(static_cast<int>(v));
      }
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::size_t v = 0; v < step_m.size(); ++v) {
          if (free_[v]) step_m[v] *= improve(static_cast<int>(v), step_m[v], flat) ? 1.2 : 0.5;
        }
      }
    }
  }

  double longest_edge_m(int vertex) const {
    double longest_m = 0.0;
    for (const int c : around_[vertex]) {
      const Corners& corners = grid_.cells[c].corners;
      const auto own = std::find(corners.begin(), corners.end(), vertex) - corners.begin();
      for (int d = 0; d < dim; ++d) {
        const Point<dim>& other_m = grid_.vertices[corners[own ^ 1 << d]].place_m;
        longest_m = std::max(longest_m, (other_m - grid_.vertices[vertex].place_m).norm());
      }
    }
    return longest_m;
  }

  /// @returns whether a step along some axis made the cells around better
  bool improve(int v, double step_m, double flat) {
    auto& vertex = grid_.vertices[v];
    double least = badness(v, flat);
    bool better = false;
    for (int way = 0; way < 2 * dim; ++way) {
      if (bounds_[v].in_plane[way / 2]) continue;
      const Point<dim> before_m = vertex.place_m;
      vertex.place_m[way / 2] += way % 2 == 0 ? step_m : -step_m;
      if (vertex.surface > 0) vertex.place_m = onto<dim>(*grid_.shapes[vertex.surface - 1], vertex.place_m);
      const double now = badness(v, flat);
      if (now < least) {
        least = now;
        better = true;
      } else {
        vertex.place_m = before_m;
      }
    }
    return better;
  }

  void measure() {
    grid_.edge_m.assign(grid_.shapes.size(), 0.0);
    for (const auto& cell : grid_.cells) {
      int surface = 0;
      for (const int v : cell.corners) surface = std::max(surface, grid_.vertices[v].surface);
      if (surface == 0) continue;
      double sum_m = 0.0;
      for (int d = 0; d < dim; ++d) {
        double longest_m = 0.0;
        for (int v = 0; v < corner_count; ++v) {
          longest_m = std::max(
              longest_m,
              (grid_.vertices[cell.corners[v ^ 1 << d]].place_m - grid_.vertices[cell.corners[v]].place_m).norm());
        }
        sum_m += longest_m / dim;
      }
      grid_.edge_m[surface - 1] = std::max(grid_.edge_m[surface - 1], sum_m);
    }
  }

  /// Whether the quadratic cells with moved corners, and each's parts when divided once, are no flatter than allowed.
  bool regular() const {
    constexpr double near =
        1e-9;  // to the surface, of a cell's edge; not where a plane of symmetry keeps a vertex from it
    for (const auto& vertex : grid_.vertices) {
      if (vertex.surface == 0) continue;
      const double off_m = grid_.shapes[vertex.surface - 1]->signed_distance_m(scene::in_space<dim>(vertex.place_m));
      if (std::abs(off_m) > near * grid_.edge_m[vertex.surface - 1]) return false;
    }
    constexpr double least = 0.1;  // of det J over the product of its columns' lengths, at the nodes
    static const std::vector<Shape<dim>> nodes = [] {
      std::vector<Shape<dim>> list;
      for (int n = 0; n < power(3, dim); ++n) {
        Point<dim> xi;
        for (int d = 0; d < dim; ++d) xi[d] = 0.5 * (n / power(3, d) % 3);
        list.emplace_back(xi);
      }
      return list;
    }();
    for (const auto& cell : grid_.cells) {
      if (std::none_of(cell.corners.begin(), cell.corners.end(), [&](int v) { return free_[v] != 0; })) continue;
      Eigen::Matrix<double, dim, Eigen::Dynamic> fine_m(dim, power(5, dim));
      for (int n = 0; n < power(5, dim); ++n) {
        Point<dim> xi;
        for (int d = 0; d < dim; ++d) xi[d] = 0.25 * (n / power(5, d) % 5);
        fine_m.col(n) = grid_.place_m(cell.corners, xi);
      }
      for (int part = 0; part <= corner_count; ++part) {
        Eigen::Matrix<double, dim, Shape<dim>::size> nodes_m;
        for (int n = 0; n < Shape<dim>::size; ++n) {
          int index = 0;
          for (int d = 0; d < dim; ++d) {
            const int at = n / power(3, d) % 3;
            index += (part == corner_count ? 2 * at : 2 * (part >> d & 1) + at) * power(5, d);
          }
          nodes_m.col(n) = fine_m.col(index);
        }
        for (const Shape<dim>& shape : nodes) {
          const Eigen::Matrix<double, dim, dim> jacobian_m = nodes_m * shape.gradient;
          if (jacobian_m.determinant() < least * jacobian_m.colwise().norm().prod()) return false;
        }
      }
    }
    return true;
  }

  Grid<dim>& grid_;
  int parts_;
  std::vector<Bound> bounds_;
  std::array<bool, dim> has_plane_{};     // of symmetry
  std::vector<std::vector<int>> around_;  // cells of each vertex
  std::vector<double> shares_;            // of each of the body's cells inside an inclusion
  std::vector<char> free_;                // vertices that may move
};

}  // namespace

template <int dim>
typename FollowingGrid<dim>::Point FollowingGrid<dim>::place_m(const Corners& corners, const Point& xi) const {
  return reference::place_m<dim>(*this, corners, xi.data(), dim);
}

template <int dim>
Boundary FollowingGrid<dim>::boundary(const Side& side) const {
  Point middle = Point::Zero();
  for (const int v : side) middle += vertices[v].grid / static_cast<double>(side.size());
  return body.boundary(middle);
}

template <int dim>
std::shared_ptr<const FollowingGrid<dim>> following_grid(const MappedSpec<dim>& body_cells, const scene::Body& body,
                                                         std::string& why_not) {
  constexpr double most_cells = dim == 2 ? 4000.0 : 1200.0;
  const auto grid = std::make_shared<FollowingGrid<dim>>();
  grid->body = body_cells;
  for (const scene::Inclusion& inclusion : body.inclusions) {
    if (inclusion.shape != scene::BodyShape::sphere && inclusion.shape != scene::BodyShape::ellipsoid) {
      why_not = "not every inclusion is a ball or an ellipsoid";
      return nullptr;
    }
    grid->shapes.push_back(solid_shape(inclusion, inclusion.center_m));
    grid->radius_m.push_back(-grid->shapes.back()->signed_distance_m(inclusion.center_m));
  }
  const auto count = static_cast<double>(body_cells.cells.size());
  for (int parts = 1; count > 0.0 && count * std::pow(parts, dim) <= most_cells; ++parts) {
    if (Maker<dim>(*grid, parts)()) return grid;
  }
  why_not = "an inclusion is too small, or too near to the surface, the support or another one";
  return nullptr;
}

template <int dim>
Discretisation<dim> following_mesh(const std::shared_ptr<const FollowingGrid<dim>>& coarse,
                                   const Grading<dim>& grading) {
  CellMappedSpec<dim> spec;
  for (const auto& vertex : coarse->vertices) spec.vertices_m.push_back(vertex.place_m);
  for (const auto& cell : coarse->cells) {
    spec.cells.push_back(cell.corners);
    spec.materials.push_back(cell.material);
  }
  // The mesh keeps the map, to be refined by.
  spec.place_m = [coarse](const auto& corners, const auto& xi) { return coarse->place_m(corners, xi); };
  spec.boundary = [&](const auto& side) { return coarse->boundary(side); };
  spec.grading = grading;
  return mapped_mesh(spec);
}

template struct FollowingGrid<2>;
template struct FollowingGrid<3>;
template std::shared_ptr<const FollowingGrid<2>> following_grid(const MappedSpec<2>&, const scene::Body&, std::string&);
template std::shared_ptr<const FollowingGrid<3>> following_grid(const MappedSpec<3>&, const scene::Body&, std::string&);
template Discretisation<2> following_mesh(const std::shared_ptr<const FollowingGrid<2>>&, const Grading<2>&);
template Discretisation<3> following_mesh(const std::shared_ptr<const FollowingGrid<3>>&, const Grading<3>&);

}  // namespace touchstone::reference
