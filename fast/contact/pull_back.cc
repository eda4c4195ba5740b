#include "fast/contact/pull_back.h"

#include "fast/contact/rest_distance.h"
#include "fast/realtime/wide_loops.h"
#include "scene/base/index.h"
#include "scene/shape/solids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace touchstone::fast {
namespace {

using scene::SurfaceQuery;
using scene::Vec3;
using Foot = PullBackScratch::Foot;
using Indices = std::vector<std::int32_t>;

/// Between two points that tell the slope, in parts of the body's size.
constexpr double slope_step_rel = 1e-4;
/// A foot is settled when the next step is shorter, in parts of the body's size: what the surface bends over that way
/// is a few micrometres.
constexpr double settled_rel = 5e-3;
constexpr int steps_max = 6;
/// A quadratic that leaves less of the displacement than this, in parts of its half width, has the right slope to about
/// a tenth, which costs half a hundredth of the distance.
constexpr double bend_max = 0.015;
/// How far aside from its foot a point may stand, in parts of its distance.
constexpr double foot_off_max = 0.05;

Vec3 at_lane(const PointLanes::Lane3& lane, std::size_t v) noexcept { return {lane[0][v], lane[1][v], lane[2][v]}; }
void set_lane(PointLanes::Lane3& lane, std::size_t v, const Vec3& x) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) lane[axis][v] = x[static_cast<int>(axis)];
}

/// Calls with the feet of one patch laid out in scratch.lanes, their numbers, as often as it takes; the last foot of a
/// block is repeated.
template <class Use>
void in_blocks(Indices& all, PullBackScratch& scratch, const Use& use) noexcept {
  const auto patch_of = [&](std::int32_t i) { return nth(scratch.foot, i).rest.patch; };
  for (auto begin = all.begin(); begin != all.end();) {
    const int patch = patch_of(*begin);
    const auto end = std::partition(begin, all.end(), [&](std::int32_t i) { return patch_of(i) == patch; });
    while (begin != end) {
      const auto count = std::min(static_cast<std::size_t>(end - begin), PointLanes::size);
      for (std::size_t v = 0; v < PointLanes::size; ++v) {
        const SurfaceQuery& rest = nth(scratch.foot, begin[static_cast<std::ptrdiff_t>(std::min(v, count - 1))]).rest;
        set_lane(scratch.lanes.point_m, v, rest.point_m);
        set_lane(scratch.lanes.normal, v, rest.normal);
      }
      use(patch, std::span<const std::int32_t>(&*begin, count));
      begin += static_cast<std::ptrdiff_t>(count);
    }
  }
}

/// Two directions along the surface, not of unit length, that span its tangent plane.
struct Tangents {
  Vec3 t1, t2;
  explicit Tangents(const Vec3& normal) noexcept {
    const bool x = std::abs(normal.x()) < 0.6;
    t1 = x ? Vec3(0.0, normal.z(), -normal.y()) : Vec3(-normal.z(), 0.0, normal.x());
    t2 = normal.cross(t1);
  }
};

/// The displaced surface as a plane, spanned by what a step along t1 and along t2 becomes.
struct Slope {
  Vec3 normal;
  scene::Mat3 way;  ///< from how far a point stands off to the way its foot is off along the rest surface

  Slope(const Vec3& rest_normal, const Tangents& t, const Vec3& y1, const Vec3& y2) noexcept {
    const double a11 = y1.squaredNorm(), a12 = y1.dot(y2), a22 = y2.squaredNorm();
    const double determinant = a11 * a22 - a12 * a12;
    // A surface folded flat has no slope to follow.
    if (!(determinant > 1e-6)) {
      normal = rest_normal;
      way.setZero();
      return;
    }
    normal = y1.cross(y2) / std::sqrt(determinant);
    way = (t.t1 * (a22 * y1 - a12 * y2).transpose() + t.t2 * (a11 * y2 - a12 * y1).transpose()) / determinant;
  }
};

/// Heights of points over the rest surface less a quadratic of their places a and b, each given as a plane.
TOUCHSTONE_WIDE_LOOPS
void heights_m(const RegionPoints& points, const std::array<double, 4>& a_of, const std::array<double, 4>& b_of,
               const std::array<double, 6>& quadratic, double* out) noexcept {
  const double *x = points.x_W_m, *y = points.y_W_m, *z = points.z_W_m, *depth_m = points.depth_m;
  const auto [ax, ay, az, a0] = a_of;
  const auto [bx, by, bz, b0] = b_of;
  const auto [c0, c1, c2, c3, c4, c5] = quadratic;
  const int count = points.count;
  // Columns never overlap.
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const double a = ax * x[i] + ay * y[i] + az * z[i] + a0, b = bx * x[i] + by * y[i] + bz * z[i] + b0;
    out[i] = -depth_m[i] - (c0 + a * (c1 + a * c3 + b * c4) + b * (c2 + b * c5));
  }
}

/// The displacement across a region as a quadratic of the place over the plane that touches the rest surface in the
/// region's middle, by least squares from one block of points. It tells which points are outside for sure, and guesses
/// the feet of the others.
class Sheet {
 public:
  template <class Body>
  Sheet(const Body& body, const DisplacedSurface& surface, const RegionPoints& points, const QuadraticFit& fit,
        PointLanes& lanes) noexcept {
    Vec3 low_m = points.p_W_m(0), high_m = low_m;
    for (std::size_t i = 1; i < static_cast<std::size_t>(points.count); ++i) {
      low_m = low_m.cwiseMin(points.p_W_m(i));
      high_m = high_m.cwiseMax(points.p_W_m(i));
    }
    const SurfaceQuery middle = closest(body, 0.5 * (low_m + high_m));
    middle_m_ = middle.point_m;
    const Tangents t(middle.normal);
    t1_ = t.t1.normalized();
    t2_ = t.t2.normalized();
    const Vec3 half_m = 0.5 * (high_m - low_m);
    reach_m_ = std::max({half_m.dot(t1_.cwiseAbs()), half_m.dot(t2_.cwiseAbs()), 1e-6 * half_m.norm(), 1e-9});
    // As far as the closest rest point of any of the points can lie.
    const double deepest_m = *std::max_element(points.depth_m, points.depth_m + points.count);
    const double all_m = reach_m_ + std::max(deepest_m, 0.0);
    one_patch_ = true;
    for (const double a : {-all_m, all_m}) {
      for (const double b : {-all_m, all_m}) {
        one_patch_ = one_patch_ && closest(body, middle_m_ + a * t1_ + b * t2_).patch == middle.patch;
      }
    }
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      const SurfaceQuery at = closest(body, middle_m_ + reach_m_ * (fit.place[v].x() * t1_ + fit.place[v].y() * t2_));
      set_lane(lanes.point_m, v, at.point_m);
      set_lane(lanes.normal, v, at.normal);
    }
    surface.displace(middle.patch, lanes);
    Eigen::Matrix<double, PointLanes::size, 4> samples;
    double aside_m = 0.0;
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      const Vec3 u_m = at_lane(lanes.displacement_m, v), normal = at_lane(lanes.normal, v);
      const double up_m = u_m.dot(normal);
      aside_m = std::max(aside_m, (u_m - up_m * normal).norm());
      samples.row(static_cast<Eigen::Index>(v)) << u_m.transpose(), up_m;
    }
    u_m_.noalias() = fit.solve.lazyProduct(samples);
    const double off_m = (fit.terms.lazyProduct(u_m_.col(3)) - samples.col(3)).cwiseAbs().maxCoeff();
    const auto up = u_m_.col(3).cwiseAbs();
    const double slope = (std::max(up[1], up[2]) + up[4] + 2.0 * std::max(up[3], up[5])) / reach_m_;
    margin_m_ = one_patch_ ? 2.0 * off_m + 2.0 * slope * aside_m : std::numeric_limits<double>::infinity();
    patch_ = middle.patch;
    normal_ = middle.normal;
    knows_slope_ = one_patch_ && off_m < bend_max * reach_m_;
  }

  /// Else another patch may move otherwise, and nothing is known of the points.
  [[nodiscard]] bool one_patch() const noexcept { return one_patch_; }
  /// Whether its slope is that of the displaced surface within a tenth or so, at a point of the rest surface.
  [[nodiscard]] bool knows_slope(const SurfaceQuery& rest) const noexcept {
    return knows_slope_ && rest.patch == patch_ && rest.normal.dot(normal_) > 0.9;
  }
  /// Outward normal of the displaced surface there.
  [[nodiscard]] Vec3 normal(const SurfaceQuery& rest) const noexcept {
    const double a = (rest.point_m - middle_m_).dot(t1_) / reach_m_, b = (rest.point_m - middle_m_).dot(t2_) / reach_m_;
    const auto up = u_m_.col(3);
    const double rise1 = (up[1] + 2.0 * a * up[3] + b * up[4]) / reach_m_;
    const double rise2 = (up[2] + 2.0 * b * up[5] + a * up[4]) / reach_m_;
    return (rest.normal - rise1 * t1_ - rise2 * t2_).normalized();
  }

  /// Heights of the points over the displaced surface, less than which it may be; where that is above 0, the point is
  /// outside for sure.
  void least_heights_m(const RegionPoints& points, double* out) const noexcept {
    const Vec3 t1 = t1_ / reach_m_, t2 = t2_ / reach_m_;
    const auto up = u_m_.col(3);
    heights_m(points, {t1.x(), t1.y(), t1.z(), -t1.dot(middle_m_)}, {t2.x(), t2.y(), t2.z(), -t2.dot(middle_m_)},
              {up[0] + margin_m_, up[1], up[2], up[3], up[4], up[5]}, out);
  }
  /// A point whose closest rest point is about the foot of p.
  [[nodiscard]] Vec3 operator()(const Vec3& p_m, const Vec3& normal, double depth_m) const noexcept {
    const double a = (p_m - middle_m_).dot(t1_) / reach_m_, b = (p_m - middle_m_).dot(t2_) / reach_m_;
    const auto value = [&](int axis) {
      const auto c = u_m_.col(axis);
      return c[0] + a * (c[1] + a * c[3] + b * c[4]) + b * (c[2] + b * c[5]);
    };
    const Vec3 u_m(value(0), value(1), value(2));
    const auto up = u_m_.col(3);
    const double rise1 = (up[1] + 2.0 * a * up[3] + b * up[4]) / reach_m_;
    const double rise2 = (up[2] + 2.0 * b * up[5] + a * up[4]) / reach_m_;
    const double over_m = (-depth_m - u_m.dot(normal)) / (1.0 + rise1 * rise1 + rise2 * rise2);
    return p_m - u_m + over_m * (rise1 * t1_ + rise2 * t2_);
  }

 private:
  Vec3 middle_m_, normal_, t1_, t2_;
  int patch_;
  bool one_patch_, knows_slope_;
  double reach_m_, margin_m_;
  Eigen::Matrix<double, 6, 4> u_m_;  ///< coefficients of 1, a, b, a^2, a b, b^2; of the vector and along the normal
};

/// Not if it stands over the surface in the cone that no surface of a slope below 45 degrees reaches into.
bool may_be_inside(const Vec3& off_m, const Vec3& normal) noexcept {
  const double over_m = off_m.dot(normal);
  return !(over_m > 0.0 && 2.0 * over_m * over_m > off_m.squaredNorm());
}

template <class Body>
InsideSummary pull_back(const scene::Shape& shape, const DisplacedSurface& surface, RegionPoints& points,
                        PullBackScratch& scratch) noexcept {
  InsideSummary summary;
  if (points.count == 0) return summary;
  const Body& body = static_cast<const Body&>(shape);
  const scene::Bounds bounds = body.bounds();
  const double size_m = (bounds.upper_m - bounds.lower_m).maxCoeff();
  const double step_m = slope_step_rel * size_m, settled_m2 = settled_rel * size_m * settled_rel * size_m;
  const auto p_W_m = [&](std::int32_t i) { return points.p_W_m(static_cast<std::size_t>(i)); };
  const auto foot = [&](std::int32_t i) -> Foot& { return nth(scratch.foot, i); };

  const Sheet sheet(body, surface, points, scratch.fit, scratch.lanes);
  sheet.least_heights_m(points, scratch.height_m.data());
  scratch.seeking.clear();
  for (std::int32_t i = 0; i < points.count; ++i) {
    Foot& here = foot(i);
    here.distance_m = 0.0;
    if (nth(scratch.height_m, i) >= 0.0) continue;
    const Vec3 p_m = p_W_m(i);
    const double depth_m = points.depth_m[i];
    here.rest = closest(body, p_m);
    if (sheet.one_patch()) here.rest = closest(body, sheet(p_m, here.rest.normal, depth_m));
    here.settled = false;
    scratch.seeking.push_back(i);
  }
  PointLanes &lanes = scratch.lanes, &beside = scratch.beside, &across = scratch.across;
  for (int step = 1; !scratch.seeking.empty(); ++step) {
    scratch.near.clear();
    in_blocks(scratch.seeking, scratch, [&](int patch, std::span<const std::int32_t> block) {
      surface.displace(patch, lanes);
      for (std::size_t v = 0; v < block.size(); ++v) {
        Foot& here = foot(block[v]);
        const Vec3 off_m = p_W_m(block[v]) - here.rest.point_m - at_lane(lanes.displacement_m, v);
        here.overshot = step > 1 && off_m.squaredNorm() > here.off_m.squaredNorm();
        if (!here.overshot) here.off_m = off_m;
        if (!here.overshot && sheet.knows_slope(here.rest)) {
          const double over_m = off_m.dot(sheet.normal(here.rest));
          const double aside_m2 = off_m.squaredNorm() - over_m * over_m;
          if (aside_m2 < foot_off_max * foot_off_max * over_m * over_m + step_m * step_m) {
            here.distance_m = over_m;
            continue;
          }
        }
        const bool last = here.settled || step == steps_max;
        if (last && here.overshot) {
          here.rest = closest(body, here.from_m);
          here.distance_m = std::copysign(here.off_m.norm(), here.off_m.dot(here.normal));
        } else if (last) {
          here.distance_m = here.off_m.dot(here.normal);
        } else if (here.overshot || may_be_inside(off_m, here.rest.normal)) {
          scratch.near.push_back(block[v]);
        }
      }
    });
    scratch.seeking.clear();
    std::erase_if(scratch.near, [&](std::int32_t i) {
      Foot& here = foot(i);
      if (!here.overshot) return false;
      here.way_m *= 0.5;
      here.rest = closest(body, here.from_m + here.way_m);
      scratch.seeking.push_back(i);
      return true;
    });
    in_blocks(scratch.near, scratch, [&](int patch, std::span<const std::int32_t> block) {
      for (std::size_t v = 0; v < PointLanes::size; ++v) {
        const Vec3 point_m = at_lane(lanes.point_m, v), normal = at_lane(lanes.normal, v);
        const Tangents t(normal);
        set_lane(beside.point_m, v, point_m + step_m * t.t1);
        set_lane(across.point_m, v, point_m + step_m * t.t2);
      }
      beside.normal = across.normal = lanes.normal;
      surface.displace(patch, beside);
      surface.displace(patch, across);
      for (std::size_t v = 0; v < block.size(); ++v) {
        Foot& here = foot(block[v]);
        const Tangents t(here.rest.normal);
        const Vec3 u_m = p_W_m(block[v]) - here.rest.point_m - here.off_m;
        const Slope slope(here.rest.normal, t, t.t1 + (at_lane(beside.displacement_m, v) - u_m) / step_m,
                          t.t2 + (at_lane(across.displacement_m, v) - u_m) / step_m);
        here.normal = slope.normal;
        here.from_m = here.rest.point_m;
        here.way_m = slope.way * here.off_m;
        here.rest = closest(body, here.from_m + here.way_m);
        here.settled = !(here.way_m.squaredNorm() > settled_m2);
        scratch.seeking.push_back(block[v]);
      }
    });
  }

  int kept = 0;
  for (std::int32_t i = 0; i < points.count; ++i) {
    const Foot& here = foot(i);
    if (!(here.distance_m < 0.0)) continue;
    if (kept != i) points.move(i, kept);
    const auto k = static_cast<std::size_t>(kept++);
    const Vec3 back_m = here.rest.point_m + here.distance_m * here.rest.normal;
    points.x_W_m[k] = back_m.x();
    points.y_W_m[k] = back_m.y();
    points.z_W_m[k] = back_m.z();
    points.depth_m[k] = -here.distance_m;
    if (points.spread) points.set_rest_normal(static_cast<int>(k), here.rest.normal);
    summary.add(here.rest.normal, points.depth_m[k], points.area_m2[k]);
  }
  points.count = kept;
  return summary;
}

}  // namespace

QuadraticFit::QuadraticFit() {
  for (std::size_t v = 0; v < PointLanes::size; ++v) {
    // A grid of 6 by 5, and the middle.
    const std::size_t row = v / 6;
    const double a = v < 30 ? -1.0 + 0.4 * static_cast<double>(v % 6) : 0.0;
    const double b = v < 30 ? -1.0 + 0.5 * static_cast<double>(row) : 0.0;
    place[v] = {a, b};
    terms.row(static_cast<Eigen::Index>(v)) << 1.0, a, b, a * a, a * b, b * b;
  }
  solve = (terms.transpose() * terms).ldlt().solve(terms.transpose());
}

PullBackScratch::PullBackScratch(int points) : foot(static_cast<std::size_t>(points)), height_m(foot.size()) {
  seeking.reserve(foot.size());
  near.reserve(foot.size());
}

std::size_t PullBackScratch::memory_bytes() const noexcept {
  return sizeof(PullBackScratch) + foot.size() * (sizeof(Foot) + sizeof(double) + 2 * sizeof(std::int32_t));
}

PullBack pull_back_for(const scene::Shape& shape) noexcept {
  return scene::as_solid<PullBack>(shape, []<class Body>() -> PullBack { return &pull_back<Body>; });
}

}  // namespace touchstone::fast
