#include "fast/pull_back.h"

#include "fast/patch_kernels.h"
#include "fast/rest_distance.h"

#include <algorithm>
#include <cmath>
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

SurfaceQuery closest(const scene::Shape& shape, const Vec3& p_m) noexcept { return shape.query(p_m); }
SurfaceQuery closest(const scene::Box& box, const Vec3& p_m) noexcept {
  const Vec3 local = p_m - box.center_m(), above_face = local.cwiseAbs() - box.half_m();
  const bool x = above_face.x() >= above_face.y() && above_face.x() >= above_face.z();
  const int axis = x ? 0 : above_face.y() >= above_face.z() ? 1 : 2;
  // A point over a face, or inside.
  const double height_m = above_face[axis];
  if (above_face[(axis + 1) % 3] > 0.0 || above_face[(axis + 2) % 3] > 0.0) return box.query(p_m);
  const bool positive = !(local[axis] < 0.0);
  SurfaceQuery at{height_m, p_m, Vec3::Zero(), 2 * axis + (positive ? 1 : 0)};
  at.point_m[axis] = box.center_m()[axis] + (positive ? box.half_m()[axis] : -box.half_m()[axis]);
  at.normal[axis] = positive ? 1.0 : -1.0;
  return at;
}

Vec3 at_lane(const PointLanes::Lane3& lane, std::size_t v) noexcept { return {lane[0][v], lane[1][v], lane[2][v]}; }
void set_lane(PointLanes::Lane3& lane, std::size_t v, const Vec3& x) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) lane[axis][v] = x[static_cast<int>(axis)];
}

/// Calls with the feet of one patch laid out in scratch.lanes, their numbers, as often as it takes; the last foot of a
/// block is repeated.
template <class Use>
void in_blocks(Indices& all, PullBackScratch& scratch, const Use& use) noexcept {
  const auto patch_of = [&](std::int32_t i) { return scratch.foot[static_cast<std::size_t>(i)].rest.patch; };
  for (auto begin = all.begin(); begin != all.end();) {
    const int patch = patch_of(*begin);
    const auto end = std::partition(begin, all.end(), [&](std::int32_t i) { return patch_of(i) == patch; });
    while (begin != end) {
      const auto count = std::min(static_cast<std::size_t>(end - begin), PointLanes::size);
      for (std::size_t v = 0; v < PointLanes::size; ++v) {
        const SurfaceQuery& rest =
            scratch.foot[static_cast<std::size_t>(begin[static_cast<std::ptrdiff_t>(std::min(v, count - 1))])].rest;
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

/// Guesses feet by the displacement across the region, taken as affine.
template <class Body>
class Guess {
 public:
  Guess(const Body& body, const DisplacedSurface& surface, const RegionPoints& points, double step_m,
        PointLanes& lanes) noexcept {
    Vec3 low_m = points.p_W_m(0), high_m = low_m;
    for (std::size_t i = 1; i < static_cast<std::size_t>(points.count); ++i) {
      low_m = low_m.cwiseMin(points.p_W_m(i));
      high_m = high_m.cwiseMax(points.p_W_m(i));
    }
    const double reach_m = std::max(0.5 * (high_m - low_m).maxCoeff(), step_m);
    const SurfaceQuery middle = closest(body, 0.5 * (low_m + high_m));
    middle_m_ = middle.point_m;
    const Tangents t(middle.normal);
    const std::array<Vec3, 5> places = {Vec3::Zero(), t.t1, -t.t1, t.t2, -t.t2};
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      set_lane(lanes.point_m, v, middle_m_ + reach_m * places[std::min<std::size_t>(v, 4)]);
      set_lane(lanes.normal, v, middle.normal);
    }
    surface.displace(middle.patch, lanes);
    const auto u = [&](std::size_t v) { return at_lane(lanes.displacement_m, v); };
    const Vec3 u1 = (u(1) - u(2)) / (2.0 * reach_m), u2 = (u(3) - u(4)) / (2.0 * reach_m);
    const double t2 = t.t1.squaredNorm();
    u_m_ = u(0);
    per_m_ = (u1 * t.t1.transpose() + u2 * t.t2.transpose()) / t2;
    lean_ = Slope(middle.normal, t, t.t1 + u1, t.t2 + u2).way * middle.normal;
  }
  /// A point whose closest rest point is about the foot of p. @param rest closest rest point of p itself
  [[nodiscard]] Vec3 operator()(const Vec3& p_m, const SurfaceQuery& rest) const noexcept {
    const Vec3 back_m = p_m - u_m_ - per_m_ * (rest.point_m - middle_m_);
    return back_m + (back_m - rest.point_m).dot(rest.normal) * lean_;
  }

 private:
  Vec3 middle_m_, u_m_;
  scene::Mat3 per_m_;  ///< of the displacement
  Vec3 lean_;          ///< how far a foot lies aside per depth
};

/// Not if it stands over the surface in the cone that no surface of a slope below 45 degrees reaches into.
bool may_be_inside(const Vec3& off_m, const Vec3& normal) noexcept {
  const double over_m = off_m.dot(normal);
  return !(over_m > 0.0 && 2.0 * over_m * over_m > off_m.squaredNorm());
}

}  // namespace

PullBackScratch::PullBackScratch(int points) : foot(static_cast<std::size_t>(points)) {
  seeking.reserve(foot.size());
  near.reserve(foot.size());
}

std::size_t PullBackScratch::memory_bytes() const noexcept {
  return sizeof(PullBackScratch) + foot.size() * (sizeof(Foot) + 2 * sizeof(std::int32_t));
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
  const auto foot = [&](std::int32_t i) -> Foot& { return scratch.foot[static_cast<std::size_t>(i)]; };

  const Guess<Body> guess(body, surface, points, step_m, scratch.lanes);
  scratch.seeking.clear();
  for (std::int32_t i = 0; i < points.count; ++i) {
    const Vec3 p_m = p_W_m(i);
    foot(i).rest = closest(body, guess(p_m, closest(body, p_m)));
    foot(i).distance_m = 0.0;
    foot(i).settled = false;
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
    summary.add(here.rest.normal, points.depth_m[k], points.area_m2[k]);
  }
  points.count = kept;
  return summary;
}

template InsideSummary pull_back<scene::Box>(const scene::Shape&, const DisplacedSurface&, RegionPoints&,
                                             PullBackScratch&) noexcept;
template InsideSummary pull_back<scene::Sphere>(const scene::Shape&, const DisplacedSurface&, RegionPoints&,
                                                PullBackScratch&) noexcept;
template InsideSummary pull_back<scene::Ellipsoid>(const scene::Shape&, const DisplacedSurface&, RegionPoints&,
                                                   PullBackScratch&) noexcept;
template InsideSummary pull_back<scene::Revolution>(const scene::Shape&, const DisplacedSurface&, RegionPoints&,
                                                    PullBackScratch&) noexcept;

}  // namespace touchstone::fast
