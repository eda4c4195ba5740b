#include "fast/skeleton/anchor_rule.h"

#include "scene/base/index.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace touchstone::fast {
namespace {

using Vec2 = Eigen::Vector2d;
using scene::Vec3;

/// Angle below which a curve counts as smooth [rad], as for the shapes.
constexpr double smooth_turn = 1e-7;

// The anchor point rule on a plane curve.

/// Samples the curvature of the whole curve on one scale.
class CurveRule {
 public:
  explicit CurveRule(std::span<const CurvePiece> pieces) : pieces_(pieces) {
    for (const CurvePiece& piece : pieces) length_m_ += piece.length_m;
    largest_per_m_ = 1.0 / length_m_;
    for (const CurvePiece& piece : pieces) {
      for (int i = 0; i <= samples; ++i) {
        largest_per_m_ = std::max(largest_per_m_, std::abs(piece.at(place(i)).curvature_per_m));
      }
    }
  }

  [[nodiscard]] std::vector<CurveAnchor> search() {
    const int last = static_cast<int>(pieces_.size()) - 1;
    end_on_axis(0, 0.0);
    for (int k = 0; k <= last; ++k) {
      inside(k);
      if (k < last) joint(k);
    }
    end_on_axis(last, 1.0);
    return std::move(found_);
  }

 private:
  static constexpr int samples = 256;
  static double place(int i) noexcept { return static_cast<double>(i) / samples; }

  [[nodiscard]] double curvature(int piece, double s) const { return nth(pieces_, piece).at(s).curvature_per_m; }
  /// Sign of a difference of curvatures: -1 or 1, or 0 if it is round-off.
  [[nodiscard]] int sign(double difference_per_m) const noexcept {
    return std::abs(difference_per_m) <= 1e-10 * largest_per_m_ ? 0 : difference_per_m > 0.0 ? 1 : -1;
  }
  static AnchorReason extremum(int rising) noexcept {
    return rising > 0 ? AnchorReason::curvature_maximum : AnchorReason::curvature_minimum;
  }

  void end_on_axis(int piece, double s) {
    const CurvePiece::Point end = nth(pieces_, piece).at(s);
    if (std::abs(end.normal.x()) > smooth_turn) {
      found_.push_back({piece, s, AnchorReason::natural_vertex});
      return;
    }
    // By mirror symmetry the curvature is stationary here; the extremum is isolated if the curvature changes.
    const int away = sign(end.curvature_per_m - curvature(piece, s == 0.0 ? place(1) : place(samples - 1)));
    if (away != 0) found_.push_back({piece, s, extremum(away)});
  }

  void joint(int k) {
    const CurvePiece &before = nth(pieces_, k), &after = nth(pieces_, k + 1);
    const CurvePiece::Point end = before.at(1.0), begin = after.at(0.0);
    if ((end.normal - begin.normal).norm() > smooth_turn) {
      found_.push_back({k, 1.0, AnchorReason::profile_corner});
      return;
    }
    if (std::abs(end.curvature_per_m - begin.curvature_per_m) > 1e-6 * largest_per_m_) {
      found_.push_back({k, 1.0, AnchorReason::curvature_jump});
      return;
    }
    // One-sided derivatives of second order.
    const auto rate = [&](int piece, double s, double step) {
      const double l = nth(pieces_, piece).length_m;
      return (-3.0 * curvature(piece, s) + 4.0 * curvature(piece, s + step) - curvature(piece, s + 2.0 * step)) /
             (2.0 * step * l);
    };
    const double rate_before = rate(k, 1.0, -1.0 / samples), rate_after = rate(k + 1, 0.0, 1.0 / samples);
    const double shorter_m = std::min(before.length_m, after.length_m);
    if (std::abs(rate_before - rate_after) * shorter_m > 1e-3 * largest_per_m_) {
      found_.push_back({k, 1.0, AnchorReason::curvature_rate_jump});
      return;
    }
    const double left = curvature(k, place(samples - 1)), right = curvature(k + 1, place(1));
    const int rising = sign(end.curvature_per_m - left), falling = sign(begin.curvature_per_m - right);
    if (rising != 0 && rising == falling) found_.push_back({k, 1.0, extremum(rising)});
    if (sign(left) * sign(right) < 0 && sign(end.curvature_per_m) == 0) {
      found_.push_back({k, 1.0, AnchorReason::inflection});
    }
  }

  void inside(int k) {
    int trend = 0, side = sign(curvature(k, 0.0));
    double trend_s = 0.0, side_s = 0.0;
    double before = curvature(k, 0.0);
    for (int i = 1; i <= samples; ++i) {
      const double here = curvature(k, place(i));
      if (const int now = sign(here - before); now != 0) {
        // At most two steps without change between rise and fall; otherwise the extremum is not isolated.
        if (trend * now < 0 && place(i) - trend_s < 4.5 / samples) {
          found_.push_back({k, sharpest(k, trend_s, place(i), trend), extremum(trend)});
        }
        trend = now;
        trend_s = place(i - 1);
      }
      if (const int now = sign(here); now != 0) {
        if (side * now < 0) found_.push_back({k, zero(k, side_s, place(i)), AnchorReason::inflection});
        side = now;
        side_s = place(i);
      }
      before = here;
    }
  }

  /// Position of the extremal curvature between two places, by ternary search.
  [[nodiscard]] double sharpest(int k, double low, double high, int direction) const {
    for (int i = 0; i < 80; ++i) {
      const double third = (high - low) / 3.0, a = low + third, b = high - third;
      (direction * (curvature(k, a) - curvature(k, b)) < 0.0 ? low : high) =
          direction * (curvature(k, a) - curvature(k, b)) < 0.0 ? a : b;
    }
    return 0.5 * (low + high);
  }
  [[nodiscard]] double zero(int k, double low, double high) const {
    const bool rises = curvature(k, high) > 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((curvature(k, middle) > 0.0) == rises ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }

  std::span<const CurvePiece> pieces_;
  double length_m_ = 0.0, largest_per_m_ = 0.0;
  std::vector<CurveAnchor> found_;
};

// The anchor point rule on a surface, by its patches.

/// Adds a point unless it is known already.
void add(std::vector<FoundAnchor>& found, const FoundAnchor& anchor, double near_m) {
  const bool known = std::any_of(found.begin(), found.end(), [&](const FoundAnchor& other) {
    return (other.point_m - anchor.point_m).norm() < near_m;
  });
  if (!known) found.push_back(anchor);
}

/// Points where three or more patches with different normals meet.
std::vector<FoundAnchor> natural_vertices(const scene::Shape& shape, double size_m) {
  struct Corner {
    Vec3 point_m;
    std::vector<Vec3> normals;
  };
  std::vector<Corner> corners;
  for (int patch = 0; patch < shape.patch_count(); ++patch) {
    for (const double u : {0.0, 1.0}) {
      for (const double v : {0.0, 1.0}) {
        const scene::SurfacePoint p = shape.at(patch, u, v);
        auto here = std::find_if(corners.begin(), corners.end(), [&](const Corner& corner) {
          return (corner.point_m - p.point_m).norm() < 1e-9 * size_m;
        });
        if (here == corners.end()) here = corners.insert(corners.end(), {p.point_m, {}});
        const bool known = std::any_of(here->normals.begin(), here->normals.end(),
                                       [&](const Vec3& normal) { return (normal - p.normal).norm() < smooth_turn; });
        if (!known) here->normals.push_back(p.normal);
      }
    }
  }
  std::vector<FoundAnchor> found;
  for (const Corner& corner : corners) {
    if (corner.normals.size() >= 3) found.push_back({corner.point_m, AnchorReason::natural_vertex});
  }
  return found;
}

/// The Gaussian curvature of a smooth closed surface as a function of the place on it, in units of the body's size.
class CurvatureField {
 public:
  CurvatureField(const scene::Shape& shape, double size_m) : shape_(shape), size_m_(size_m) {
    double least = INFINITY, most = -INFINITY;
    for (int patch = 0; patch < shape.patch_count(); ++patch) {
      for (int i = 0; i < starts; ++i) {
        for (int j = 0; j < starts; ++j) {
          start_.push_back({patch, (i + 0.5) / starts, (j + 0.5) / starts, Vec3::Zero()});
          start_.back().point_m = shape.at(patch, start_.back().u, start_.back().v).point_m;
        }
      }
      for (int i = 0; i <= grid; ++i) {
        for (int j = 0; j <= grid; ++j) {
          const scene::SurfacePoint p = shape.at(patch, static_cast<double>(i) / grid, static_cast<double>(j) / grid);
          const double sharp = p.curvature_max_per_m * size_m, blunt = p.curvature_min_per_m * size_m;
          least = std::min({least, sharp, blunt});
          most = std::max({most, sharp, blunt});
          const bool known = std::any_of(points_m_.begin(), points_m_.end(), [&](const Vec3& other_m) {
            return (other_m - p.point_m).norm() < 1e-9 * size_m;
          });
          if (!known) points_m_.push_back(p.point_m);
        }
      }
    }
    flat_ = std::max(std::abs(most), std::abs(least)) < 1e-9;
    constant_ = most - least <= 1e-6 * std::abs(most);
  }

  [[nodiscard]] bool flat() const noexcept { return flat_; }
  [[nodiscard]] bool constant() const noexcept { return constant_; }
  /// Points spread evenly over the surface, including the patches' corners.
  [[nodiscard]] const std::vector<Vec3>& points_m() const noexcept { return points_m_; }

  /// A point of the surface with two tangent directions.
  struct Place {
    Vec3 point_m;
    Vec3 normal, t1, t2;
  };
  [[nodiscard]] Place place(const Vec3& near_m) const {
    const scene::SurfaceQuery query = shape_.query(near_m);
    const Vec3 t1 = query.normal.unitOrthogonal();
    return {query.point_m, query.normal, t1, query.normal.cross(t1)};
  }

  /// First and second derivatives of the curvature along the surface.
  [[nodiscard]] Vec2 gradient(const Place& p) const {
    return Vec2(at(p, step, 0) - at(p, -step, 0), at(p, 0, step) - at(p, 0, -step)) / (2.0 * step);
  }
  [[nodiscard]] Eigen::Matrix2d hessian(const Place& p) const {
    const double here = at(p, 0, 0);
    Eigen::Matrix2d h;
    h(0, 0) = (at(p, step, 0) - 2.0 * here + at(p, -step, 0)) / (step * step);
    h(1, 1) = (at(p, 0, step) - 2.0 * here + at(p, 0, -step)) / (step * step);
    h(0, 1) = h(1, 0) =
        (at(p, step, step) - at(p, step, -step) - at(p, -step, step) + at(p, -step, -step)) / (4.0 * step * step);
    return h;
  }

 private:
  static constexpr int starts = 12, grid = 6;
  static constexpr double step = 1e-2;
  struct Start {
    int patch;
    double u, v;
    Vec3 point_m;
  };

  /// Curvature at the surface point closest to p + along_t1 t1 + along_t2 t2.
  [[nodiscard]] double at(const Place& p, double along_t1, double along_t2) const {
    const scene::SurfaceQuery query = shape_.query(p.point_m + size_m_ * (along_t1 * p.t1 + along_t2 * p.t2));
    const Start* start = nullptr;
    for (const Start& other : start_) {
      if (other.patch != query.patch) continue;
      if (start == nullptr ||
          (other.point_m - query.point_m).squaredNorm() < (start->point_m - query.point_m).squaredNorm()) {
        start = &other;
      }
    }
    // Parameters of that point on the patch by Gauss-Newton, from the nearest of many start points.
    Vec2 uv(start->u, start->v);
    for (int i = 0; i < 12; ++i) {
      constexpr double h = 1e-6;
      const double hu = uv.x() < 0.5 ? h : -h, hv = uv.y() < 0.5 ? h : -h;
      const Vec3 here_m = shape_.at(query.patch, uv.x(), uv.y()).point_m;
      Eigen::Matrix<double, 3, 2> J;
      J.col(0) = (shape_.at(query.patch, uv.x() + hu, uv.y()).point_m - here_m) / hu;
      J.col(1) = (shape_.at(query.patch, uv.x(), uv.y() + hv).point_m - here_m) / hv;
      const Vec3 off_m = query.point_m - here_m;
      if (off_m.norm() < 1e-13 * size_m_) break;
      Eigen::Matrix2d normal_matrix = J.transpose() * J;
      normal_matrix.diagonal().array() += 1e-12 * normal_matrix.trace();
      uv = (uv + normal_matrix.ldlt().solve(J.transpose() * off_m)).cwiseMax(0.0).cwiseMin(1.0);
    }
    const scene::SurfacePoint found = shape_.at(query.patch, uv.x(), uv.y());
    return found.curvature_max_per_m * found.curvature_min_per_m * size_m_ * size_m_;
  }

  const scene::Shape& shape_;
  double size_m_;
  std::vector<Start> start_;
  std::vector<Vec3> points_m_;
  bool flat_ = false, constant_ = false;
};

/// Intersections of the surface with two perpendicular axes through the centre in a plane; coordinate axes if the plane
/// contains two of them.
std::array<Vec3, 4> on_two_axes(const scene::Shape& shape, const Vec3& center_m, const Vec3& plane_normal,
                                const Vec3& in_plane, double size_m) {
  Vec3 first = (in_plane - in_plane.dot(plane_normal) * plane_normal).normalized();
  for (int axis = 2; axis >= 0; --axis) {
    if (std::abs(plane_normal[axis]) < 1e-6) first = Vec3::Unit(axis);
  }
  const Vec3 second = plane_normal.cross(first).normalized();
  std::array<Vec3, 4> points;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 out = (i < 2 ? 1.0 : -1.0) * (i % 2 == 0 ? first : second);
    points[i] = shape.query(center_m + 2.0 * size_m * out).point_m;
  }
  return points;
}

std::vector<FoundAnchor> stationary_points(const scene::Shape& shape, const CurvatureField& field, const Vec3& center_m,
                                           double size_m) {
  const std::vector<Vec3>& points_m = field.points_m();
  std::vector<double> steepness;
  for (const Vec3& p_m : points_m) steepness.push_back(field.gradient(field.place(p_m)).norm());
  const double steepest = *std::max_element(steepness.begin(), steepness.end());

  std::vector<FoundAnchor> found;
  std::vector<Vec3> circles;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    bool lowest = true;
    for (std::size_t j = 0; j < points_m.size() && lowest; ++j) {
      if ((points_m[j] - points_m[i]).norm() < 0.3 * size_m) lowest = steepness[i] <= steepness[j] + 1e-6 * steepest;
    }
    if (!lowest) continue;
    // Newton's method on the gradient, without a direction along which the curvature is constant.
    CurvatureField::Place p = field.place(points_m[i]);
    Vec2 gradient = field.gradient(p);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> bend(field.hessian(p));
    for (int round = 0; round < 20 && gradient.norm() > 1e-9 * steepest; ++round) {
      const double largest = bend.eigenvalues().cwiseAbs().maxCoeff();
      Vec2 move = Vec2::Zero();
      for (int k = 0; k < 2; ++k) {
        const double curve = bend.eigenvalues()[k];
        if (std::abs(curve) > 1e-4 * largest)
          move -= bend.eigenvectors().col(k).dot(gradient) / curve * bend.eigenvectors().col(k);
      }
      move *= std::min(1.0, 0.1 / std::max(move.norm(), 1e-300));
      p = field.place(p.point_m + size_m * (move.x() * p.t1 + move.y() * p.t2));
      gradient = field.gradient(p);
      bend.compute(field.hessian(p));
    }
    if (!(gradient.norm() <= 1e-4 * steepest)) continue;

    const int small = std::abs(bend.eigenvalues()[0]) < std::abs(bend.eigenvalues()[1]) ? 0 : 1;
    const double weak = bend.eigenvalues()[small], strong = bend.eigenvalues()[1 - small];
    const AnchorReason by_strong = strong < 0.0 ? AnchorReason::curvature_maximum : AnchorReason::curvature_minimum;
    if (std::abs(weak) < 1e-3 * std::abs(strong)) {
      const Vec3 along = bend.eigenvectors()(0, small) * p.t1 + bend.eigenvectors()(1, small) * p.t2;
      if (field.gradient(field.place(p.point_m + 0.2 * size_m * along)).norm() <= 1e-2 * steepest) {
        const Vec3 plane_normal = p.normal.cross(along).normalized();
        // All points of the curve lead to the same circle, which counts once.
        const bool known = std::any_of(circles.begin(), circles.end(),
                                       [&](const Vec3& other) { return std::abs(other.dot(plane_normal)) > 0.99; });
        if (known) continue;
        circles.push_back(plane_normal);
        for (const Vec3& point_m : on_two_axes(shape, center_m, plane_normal, p.point_m - center_m, size_m)) {
          add(found, {point_m, by_strong}, 1e-2 * size_m);
        }
        continue;
      }
    }
    add(found, {p.point_m, weak * strong < 0.0 ? AnchorReason::curvature_saddle : by_strong}, 1e-2 * size_m);
  }
  return found;
}

std::vector<FoundAnchor> sphere_axes(const scene::Shape& shape, const Vec3& center_m, double size_m) {
  std::vector<FoundAnchor> found;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Vec3 beyond_m = center_m + 2.0 * sign * size_m * Vec3::Unit(axis);
      found.push_back({shape.query(beyond_m).point_m, AnchorReason::sphere_axis});
    }
  }
  return found;
}

std::vector<FoundAnchor> on_circles(const scene::Revolution& revolution) {
  std::vector<FoundAnchor> found;
  for (const CurveAnchor& anchor : profile_anchors(revolution)) {
    const Vec2 rz = revolution.meridian(anchor.piece, anchor.s).rz_m;
    const Vec3 on_axis_m = revolution.offset_m() + rz.y() * Vec3::UnitZ();
    if (rz.x() == 0.0) {
      found.push_back({on_axis_m, anchor.reason});
      continue;
    }
    for (const Vec3& out : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
      found.push_back({on_axis_m + rz.x() * out, anchor.reason});
    }
  }
  return found;
}

}  // namespace

const char* words(AnchorReason reason) noexcept {
  switch (reason) {
    case AnchorReason::natural_vertex:
      return "a natural vertex";
    case AnchorReason::profile_corner:
      return "a corner of the profile";
    case AnchorReason::curvature_jump:
      return "a jump of the curvature";
    case AnchorReason::curvature_rate_jump:
      return "a jump of the curvature's first derivative";
    case AnchorReason::curvature_maximum:
      return "a maximum of the curvature";
    case AnchorReason::curvature_minimum:
      return "a minimum of the curvature";
    case AnchorReason::curvature_saddle:
      return "a saddle of the curvature";
    case AnchorReason::inflection:
      return "an inflection";
    case AnchorReason::sphere_axis:
      return "one of three perpendicular axes, the curvature being the same everywhere";
    case AnchorReason::support:
      return "the lowest point on the support";
  }
  return "";
}

std::vector<CurveAnchor> curve_anchors(std::span<const CurvePiece> pieces) { return CurveRule(pieces).search(); }

std::vector<CurveAnchor> profile_anchors(const scene::Revolution& revolution) {
  std::vector<CurvePiece> pieces;
  for (int k = 0; k < revolution.piece_count(); ++k) {
    pieces.push_back({revolution.piece(k).length_m, [&revolution, k](double s) {
                        const auto p = revolution.meridian(k, s);
                        return CurvePiece::Point{p.rz_m, p.normal, p.curvature_along_per_m};
                      }});
  }
  return curve_anchors(pieces);
}

std::vector<FoundAnchor> find_anchor_points(const scene::Shape& shape) {
  const scene::Bounds bounds = shape.bounds();
  const Vec3 center_m = 0.5 * (bounds.lower_m + bounds.upper_m);
  const double size_m = 0.5 * (bounds.upper_m - bounds.lower_m).maxCoeff();
  if (const auto* revolution = dynamic_cast<const scene::Revolution*>(&shape)) {
    std::vector<FoundAnchor> found = on_circles(*revolution);
    return found.empty() ? sphere_axes(shape, center_m, size_m) : found;
  }
  std::vector<FoundAnchor> found = natural_vertices(shape, size_m);
  const CurvatureField field(shape, size_m);
  if (!found.empty() || field.flat()) return found;
  return field.constant() ? sphere_axes(shape, center_m, size_m) : stationary_points(shape, field, center_m, size_m);
}

}  // namespace touchstone::fast
