#include "reference/tool/distance_grid.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

using scene::Mat3;
using scene::TriangleMesh;
using scene::Vec3;

/// Grid points beyond the mesh's bounding box on every side; the spline is defined up to the last but one.
constexpr int margin = 4;

/// The closest feature of a triangle: corner (0 to 2), edge from corner k - 3 (3 to 5), or the interior (6).
struct Foot {
  Vec3 point_m;
  int feature;
};

/// C. Ericson, Real-Time Collision Detection (2005), 5.1.5.
Foot foot_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + d1 / (d1 - d3) * ab, 3};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + d2 / (d2 - d6) * ac, 5};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return {b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b), 4};
  const double all = va + vb + vc;
  return {a + vb / all * ab + vc / all * ac, 6};
}

/// A mesh with the normals that give the sign of a distance.
class SignedTriangles {
 public:
  explicit SignedTriangles(const TriangleMesh& mesh) : mesh_(mesh), corner_normals_(vertex_normals(mesh)) {
    std::map<std::pair<std::int32_t, std::int32_t>, Vec3> on_edge;
    const auto edge = [](std::int32_t a, std::int32_t b) { return std::pair(std::min(a, b), std::max(a, b)); };
    for (const auto& t : mesh.triangles) {
      face_normals_.push_back((point(t[1]) - point(t[0])).cross(point(t[2]) - point(t[0])).normalized());
      for (int k = 0; k < 3; ++k) {
        on_edge.try_emplace(edge(t[k], t[(k + 1) % 3]), Vec3::Zero()).first->second += face_normals_.back();
      }
    }
    for (const auto& t : mesh.triangles) {
      std::array<Vec3, 3>& normals = edge_normals_.emplace_back();
      for (int k = 0; k < 3; ++k) normals[k] = on_edge[edge(t[k], t[(k + 1) % 3])];
    }
  }

  [[nodiscard]] Vec3 point(std::int32_t i) const { return mesh_.points_m.col(i); }
  [[nodiscard]] Foot foot(int triangle, const Vec3& p) const {
    const auto& t = mesh_.triangles[triangle];
    return foot_on_triangle(p, point(t[0]), point(t[1]), point(t[2]));
  }
  [[nodiscard]] double distance_m(int triangle, const Vec3& p) const { return (p - foot(triangle, p).point_m).norm(); }
  /// Valid if this triangle is the closest one.
  [[nodiscard]] bool inside(int triangle, const Vec3& p) const {
    const Foot nearest = foot(triangle, p);
    const Vec3 normal = nearest.feature < 3   ? Vec3(corner_normals_.col(mesh_.triangles[triangle][nearest.feature]))
                        : nearest.feature < 6 ? edge_normals_[triangle][nearest.feature - 3]
                                              : face_normals_[triangle];
    return (p - nearest.point_m).dot(normal) < 0.0;
  }

 private:
  const TriangleMesh& mesh_;
  Eigen::Matrix3Xd corner_normals_;
  std::vector<Vec3> face_normals_;
  std::vector<std::array<Vec3, 3>> edge_normals_;
};

/// Converts values at equal steps along a line to coefficients of the interpolating cubic B-splines, with zero second
/// derivative at the ends.
void to_spline(std::vector<double>& line, std::vector<double>& scratch) {
  // Thomas algorithm for (c[i-1] + 4 c[i] + c[i+1]) / 6 = f[i] between the ends, where c = f.
  const int n = static_cast<int>(line.size());
  scratch.assign(n, 0.0);
  for (int i = 1; i + 1 < n; ++i) {
    const double pivot = 4.0 - scratch[i - 1];
    scratch[i] = 1.0 / pivot;
    line[i] = (6.0 * line[i] - line[i - 1]) / pivot;
  }
  for (int i = n - 2; i > 0; --i) line[i] -= scratch[i] * line[i + 1];
}

/// The four B-splines that are not zero at t in [0, 1) of an interval, with two derivatives by t.
struct Weights {
  explicit Weights(double t) {
    const double s = 1.0 - t;
    value = {s * s * s / 6.0, 2.0 / 3.0 - t * t * (1.0 - 0.5 * t), 2.0 / 3.0 - s * s * (1.0 - 0.5 * s),
             t * t * t / 6.0};
    slope = {-0.5 * s * s, -2.0 * t + 1.5 * t * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t};
    bend = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t};
  }
  std::array<double, 4> value, slope, bend;
};

}  // namespace

Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.points_m.cols());
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 here = mesh.points_m.col(t[k]);
      const Vec3 one = Vec3(mesh.points_m.col(t[(k + 1) % 3])) - here;
      const Vec3 other = Vec3(mesh.points_m.col(t[(k + 2) % 3])) - here;
      const Vec3 across = one.cross(other);
      normals.col(t[k]) += std::atan2(across.norm(), one.dot(other)) * across.normalized();
    }
  }
  return normals;
}

std::map<std::pair<int, int>, double> edge_angles(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, Vec3> first_normal;
  std::map<std::pair<int, int>, double> angles;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points_m.col(t[0]), b = mesh.points_m.col(t[1]), c = mesh.points_m.col(t[2]);
    const Vec3 normal = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge = std::minmax(t[k], t[(k + 1) % 3]);
      const auto [other, alone] = first_normal.try_emplace(edge, normal);
      if (!alone) angles[edge] = std::atan2(other->second.cross(normal).norm(), other->second.dot(normal));
    }
  }
  return angles;
}

double grid_spacing_m(const TriangleMesh& mesh) {
  constexpr double flat_angle = 0.01;
  const auto angles = edge_angles(mesh);
  std::vector<double> shortest_m;  // of the facets of bent surfaces
  for (const auto& t : mesh.triangles) {
    double edge_m = std::numeric_limits<double>::infinity();
    bool bent = false;
    for (int k = 0; k < 3; ++k) {
      edge_m = std::min(edge_m, (mesh.points_m.col(t[(k + 1) % 3]) - mesh.points_m.col(t[k])).norm());
      const double angle = angles.at(std::minmax(t[k], t[(k + 1) % 3]));
      bent = bent || (angle > flat_angle && angle < sharp_angle);
    }
    if (bent) shortest_m.push_back(edge_m);
  }
  const scene::Bounds bounds = mesh.bounds();
  const Vec3 extent_m = bounds.upper_m - bounds.lower_m;
  double spacing_m = extent_m.minCoeff() / 20.0;
  if (!shortest_m.empty()) {
    const auto middle = shortest_m.begin() + static_cast<std::ptrdiff_t>(shortest_m.size() / 2);
    std::nth_element(shortest_m.begin(), middle, shortest_m.end());
    spacing_m = std::min(*middle / 4.0, extent_m.minCoeff() / 4.0);
  }
  const auto points = [&] { return (extent_m.array() / spacing_m + 2.0 * margin + 2.0).prod(); };
  while (points() > grid_points_max) spacing_m *= 1.05;
  return spacing_m;
}

DistanceGrid::DistanceGrid(const TriangleMesh& mesh, double spacing_m) : spacing_m_(spacing_m), bounds_(mesh.bounds()) {
  // Centred on the mesh, so that the mesh's symmetry planes are the grid's.
  const Vec3 extent_m = bounds_.upper_m - bounds_.lower_m;
  for (int axis = 0; axis < 3; ++axis) {
    count_[axis] = static_cast<int>(std::ceil(extent_m[axis] / spacing_m - 1e-9)) + 1 + 2 * margin;
    origin_m_[axis] = 0.5 * (bounds_.lower_m[axis] + bounds_.upper_m[axis]) - 0.5 * (count_[axis] - 1) * spacing_m;
  }
  sample(mesh);
  to_coefficients();
}

double DistanceGrid::half_width_m() const { return 0.5 * (bounds_.upper_m - bounds_.lower_m).minCoeff(); }

void DistanceGrid::sample(const TriangleMesh& mesh) {
  const SignedTriangles triangles(mesh);
  const std::size_t points = index(0, 0, count_[2]);
  constexpr double exact_spacings = 2.0;
  std::vector<double> distance_m(points, std::numeric_limits<double>::infinity());
  std::vector<int> nearest(points, -1);
  const auto place = [&](int i, int j, int k) -> Vec3 { return origin_m_ + spacing_m_ * Vec3(i, j, k); };
  const auto offer = [&](int triangle, int i, int j, int k) {
    const std::size_t at = index(i, j, k);
    if (triangle < 0 || triangle == nearest[at]) return;
    const double offered_m = triangles.distance_m(triangle, place(i, j, k));
    if (offered_m >= distance_m[at]) return;
    distance_m[at] = offered_m;
    nearest[at] = triangle;
  };
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    std::array<int, 3> from, to;
    for (int axis = 0; axis < 3; ++axis) {
      double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
      for (const std::int32_t corner : mesh.triangles[t]) {
        low_m = std::min(low_m, mesh.points_m(axis, corner));
        high_m = std::max(high_m, mesh.points_m(axis, corner));
      }
      from[axis] = std::max(0, static_cast<int>(std::floor((low_m - origin_m_[axis]) / spacing_m_ - exact_spacings)));
      to[axis] = std::min(count_[axis] - 1,
                          static_cast<int>(std::ceil((high_m - origin_m_[axis]) / spacing_m_ + exact_spacings)));
    }
    for (int k = from[2]; k <= to[2]; ++k) {
      for (int j = from[1]; j <= to[1]; ++j) {
        for (int i = from[0]; i <= to[0]; ++i) offer(t, i, j, k);
      }
    }
  }
  std::vector<char> exact(points), inside(points, -1);
  for (std::size_t at = 0; at < points; ++at) exact[at] = distance_m[at] <= exact_spacings * spacing_m_;

  // Fast sweeping: eight sweeps, one towards each corner of the grid; every point is updated from its seven
  // predecessors. A point more than a spacing away has the sign of its neighbours.
  for (int sweep = 0; sweep < 8; ++sweep) {
    const std::array<int, 3> step = {sweep & 1 ? -1 : 1, sweep & 2 ? -1 : 1, sweep & 4 ? -1 : 1};
    const auto range = [&](int axis, int n) { return step[axis] > 0 ? n : count_[axis] - 1 - n; };
    for (int nk = 0; nk < count_[2]; ++nk) {
      for (int nj = 0; nj < count_[1]; ++nj) {
        for (int ni = 0; ni < count_[0]; ++ni) {
          const int i = range(0, ni), j = range(1, nj), k = range(2, nk);
          const std::size_t at = index(i, j, k);
          if (exact[at]) {
            if (inside[at] < 0) inside[at] = triangles.inside(nearest[at], place(i, j, k)) ? 1 : 0;
            continue;
          }
          for (int behind = 1; behind < 8; ++behind) {
            const int bi = behind & 1 ? 1 : 0, bj = behind & 2 ? 1 : 0, bk = behind & 4 ? 1 : 0;
            if (ni < bi || nj < bj || nk < bk) continue;
            const std::size_t from = index(i - bi * step[0], j - bj * step[1], k - bk * step[2]);
            offer(nearest[from], i, j, k);
            if (inside[at] < 0) inside[at] = inside[from];
          }
        }
      }
    }
  }
  coefficient_m_.resize(points);
  for (std::size_t at = 0; at < points; ++at) coefficient_m_[at] = inside[at] > 0 ? -distance_m[at] : distance_m[at];
}

void DistanceGrid::to_coefficients() {
  std::vector<double> line, scratch;
  for (int axis = 0; axis < 3; ++axis) {
    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
    line.resize(count_[axis]);
    std::array<int, 3> place;
    for (place[one] = 0; place[one] < count_[one]; ++place[one]) {
      for (place[other] = 0; place[other] < count_[other]; ++place[other]) {
        const auto at = [&](int n) -> double& {
          place[axis] = n;
          return coefficient_m_[index(place[0], place[1], place[2])];
        };
        for (int n = 0; n < count_[axis]; ++n) line[n] = at(n);
        to_spline(line, scratch);
        for (int n = 0; n < count_[axis]; ++n) at(n) = line[n];
      }
    }
  }
}

Gap<3> DistanceGrid::at(const Vec3& p_T_m) const {
  Gap<3> g;
  const Vec3 place = (p_T_m - origin_m_) / spacing_m_;
  std::array<int, 3> cell;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(place[axis] >= 1.0 && place[axis] < count_[axis] - 2.0)) return g;
    cell[axis] = static_cast<int>(place[axis]);
  }
  const std::array<Weights, 3> w = {Weights(place[0] - cell[0]), Weights(place[1] - cell[1]),
                                    Weights(place[2] - cell[2])};
  // Sums along x, then y, then z; xx is the second derivative by x.
  double value = 0.0;
  Vec3 slope = Vec3::Zero();
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
  for (int k = 0; k < 4; ++k) {
    double v = 0.0, dx = 0.0, dxx = 0.0, dy = 0.0, dyy = 0.0, dxy = 0.0;
    for (int j = 0; j < 4; ++j) {
      const double* row = &coefficient_m_[index(cell[0] - 1, cell[1] - 1 + j, cell[2] - 1 + k)];
      double line = 0.0, line_x = 0.0, line_xx = 0.0;
      for (int i = 0; i < 4; ++i) {
        line += w[0].value[i] * row[i];
        line_x += w[0].slope[i] * row[i];
        line_xx += w[0].bend[i] * row[i];
      }
      v += w[1].value[j] * line;
      dx += w[1].value[j] * line_x;
      dxx += w[1].value[j] * line_xx;
      dy += w[1].slope[j] * line;
      dxy += w[1].slope[j] * line_x;
      dyy += w[1].bend[j] * line;
    }
    value += w[2].value[k] * v;
    slope += Vec3(w[2].value[k] * dx, w[2].value[k] * dy, w[2].slope[k] * v);
    xx += w[2].value[k] * dxx;
    yy += w[2].value[k] * dyy;
    zz += w[2].bend[k] * v;
    xy += w[2].value[k] * dxy;
    xz += w[2].slope[k] * dx;
    yz += w[2].slope[k] * dy;
  }
  g.value_m = value;
  g.gradient = slope / spacing_m_;
  g.hessian_per_m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  g.hessian_per_m /= spacing_m_ * spacing_m_;
  return g;
}

}  // namespace touchstone::reference
