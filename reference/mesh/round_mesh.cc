#include "reference/mesh/round_mesh.h"

#include "scene/model/solid_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace touchstone::reference {
namespace {

using Vec2 = Eigen::Vector2d;
using scene::Revolution;
using scene::RevolutionPiece;

constexpr double right_angle = 0.5 * std::numbers::pi;

/// The grid's own coordinates: q from 0 on the axis to 1, zeta from -1 at the bottom to 1 at the top. The core is
/// q, |zeta| <= core; the shell runs from it to the surface q = 1 or |zeta| = 1 in similar rectangles.
constexpr double core = 0.5;
constexpr int shell_layers = 1;

/// A stretch of the profile: within one piece, by shares of its length.
struct Section {
  int piece;
  double begin, end;
};

/// A ring where the profile is cut.
struct Ring {
  int piece;
  double share;
};

double length_m(const Revolution& shape, const Section& section) {
  return (section.end - section.begin) * shape.piece(section.piece).length_m;
}

/// Where the profile passes a height over its lowest point. It climbs all the way, but for a flat bottom and top.
Ring ring_at(const Revolution& shape, double height_m) {
  const double z_m = shape.piece(0).start_m.y() + height_m;
  int index = 0;
  while (index + 1 < shape.piece_count() && shape.piece(index).end_m.y() < z_m) ++index;
  const RevolutionPiece& piece = shape.piece(index);
  if (piece.straight()) return {index, (z_m - piece.start_m.y()) / (piece.end_m.y() - piece.start_m.y())};
  const double angle = std::asin(std::clamp((z_m - piece.center_m.y()) / piece.radius_m, -1.0, 1.0));
  return {index, (angle - piece.start_angle) / (piece.end_angle - piece.start_angle)};
}

/// How much of an end's piece, from the pole, becomes the end of the mesh: all when it is level, or low and parted from
/// a side by a corner; else a cap.
double cap_share(const Revolution& shape, bool top) {
  constexpr double sharp = 0.7, widest_cap = 0.87, widest_share = 0.55;  // [rad], [rad], of the piece
  constexpr double low = 0.25;                                           // of the body's height
  const int last = shape.piece_count() - 1;
  const RevolutionPiece& piece = shape.piece(top ? last : 0);
  const double turn_at_corner =
      top ? piece.start_angle - shape.piece(last - 1).end_angle : shape.piece(1).start_angle - piece.end_angle;
  const bool level = piece.straight() && std::abs(piece.start_angle) >= right_angle - 1e-7;
  const double height_m = shape.piece(last).end_m.y() - shape.piece(0).start_m.y();
  const bool parted = turn_at_corner > sharp && piece.end_m.y() - piece.start_m.y() < low * height_m;
  if (level || parted) return 1.0;
  const double turn = piece.end_angle - piece.start_angle;
  return turn > 0.0 ? std::min(widest_share, widest_cap / turn) : widest_share;
}

/// The largest balls inside: their radius, and the stretch of the axis that holds their centres.
struct Spine {
  double radius_m, low_m, high_m;
};

Spine spine(const Revolution& shape) {
  constexpr double nearly = 0.999;
  constexpr int steps = 60;
  const double bottom_m = shape.piece(0).start_m.y(), top_m = shape.piece(shape.piece_count() - 1).end_m.y();
  // The depth below the surface is concave along the axis.
  const auto depth_m = [&](double z_m) { return -shape.signed_distance_m({0.0, 0.0, z_m}); };
  double low_m = bottom_m, high_m = top_m;
  for (int step = 0; step < steps; ++step) {
    const double third_m = (high_m - low_m) / 3.0;
    if (depth_m(low_m + third_m) < depth_m(high_m - third_m)) {
      low_m += third_m;
    } else {
      high_m -= third_m;
    }
  }
  const double middle_m = 0.5 * (low_m + high_m), radius_m = depth_m(middle_m);
  const auto end_m = [&](double outside_m) {
    double inside_m = middle_m;
    for (int step = 0; step < steps; ++step) {
      const double half_m = 0.5 * (inside_m + outside_m);
      (depth_m(half_m) >= nearly * radius_m ? inside_m : outside_m) = half_m;
    }
    return inside_m;
  };
  return {radius_m, end_m(bottom_m), end_m(top_m)};
}

/// The profile cut into a bottom, sides and a top.
struct Cuts {
  Section bottom, top;         // bottom.begin and top.end are the poles
  std::vector<Section> sides;  // from the bottom up
};

Cuts cut(const Revolution& shape, double support_height_m) {
  const int last = shape.piece_count() - 1;
  Ring lower{0, cap_share(shape, false)};
  const Ring upper{last, 1.0 - cap_share(shape, true)};
  std::vector<Ring> rings;
  if (!shape.flat_bottom()) {
    // A support up to a little more than the cap is the cap.
    constexpr double little_more = 1.3;
    const Ring support = ring_at(shape, support_height_m);
    if (support.piece == 0 && support.share <= std::min(1.0, little_more * lower.share)) {
      lower = support;
    } else {
      rings.push_back(support);
    }
  }
  for (int k = 0; k < last; ++k) rings.push_back({k, 1.0});
  const auto before = [](const Ring& a, const Ring& b) {
    constexpr double same = 1e-9;
    return a.piece + a.share < b.piece + b.share - same;
  };
  std::sort(rings.begin(), rings.end(), before);

  Cuts cuts{{0, 0.0, lower.share}, {last, upper.share, 1.0}, {}};
  // Sides about as long as the core is thick.
  const double wished_m = 0.8 * spine(shape).radius_m;
  rings.push_back(upper);
  Ring from = lower;
  for (const Ring& to : rings) {
    if (!before(from, to)) continue;
    const Section section{to.piece, from.piece == to.piece ? from.share : 0.0, to.share};
    from = to;
    const int parts = std::max(1, static_cast<int>(std::ceil(length_m(shape, section) / wished_m - 1e-9)));
    for (int k = 0; k < parts; ++k) {
      const double step = (section.end - section.begin) / parts;
      cuts.sides.push_back(
          {to.piece, section.begin + k * step, k + 1 == parts ? section.end : section.begin + (k + 1) * step});
    }
  }
  return cuts;
}

/// From the grid's coordinates to the meridian plane.
class Meridian {
 public:
  explicit Meridian(const RoundSpec& spec)
      : shape_(spec.profile), cuts_(cut(shape_, spec.support_height_m)), bottom_m_(shape_.piece(0).start_m.y()) {
    const Spine middle = spine(shape_);
    // The core's corners: half-way from the nearest point of the body's spine.
    for (int ring = 0; ring <= layers(); ++ring) {
      const Vec2 outer_m = ring < layers() ? at(cuts_.sides[ring], 0.0) : at(cuts_.sides.back(), 1.0);
      const Vec2 spine_m(0.0, std::clamp(outer_m.y(), middle.low_m - bottom_m_, middle.high_m - bottom_m_));
      corners_m_.push_back(0.5 * (spine_m + outer_m));
    }
  }

  [[nodiscard]] int layers() const { return static_cast<int>(cuts_.sides.size()); }
  [[nodiscard]] const Cuts& cuts() const { return cuts_; }
  [[nodiscard]] const Revolution& shape() const { return shape_; }

  /// (r, z), z from the body's lowest point.
  [[nodiscard]] Vec2 place_m(double q, double zeta) const {
    const double width = std::max(core, std::abs(zeta));
    if (q <= width) {
      const double share = q / width;
      if (width == core) return core_m(share, zeta);
      const double outward = (width - core) / (1.0 - core);
      const Section& end = zeta > 0.0 ? cuts_.top : cuts_.bottom;
      const Vec2 surface_m = at(end, zeta > 0.0 ? 1.0 - share : share);
      return (1.0 - outward) * core_m(share, zeta > 0.0 ? core : -core) + outward * surface_m;
    }
    const double outward = (q - core) / (1.0 - core);
    const double zeta_at_core = zeta * core / q;
    const auto [layer, share] = layer_at(zeta_at_core);
    return (1.0 - outward) * core_m(1.0, zeta_at_core) + outward * at(cuts_.sides[layer], share);
  }

 private:
  [[nodiscard]] Vec2 at(const Section& section, double share) const {
    const double s = (1.0 - share) * section.begin + share * section.end;
    return shape_.meridian(section.piece, s).rz_m - Vec2(0.0, bottom_m_);
  }
  [[nodiscard]] std::pair<int, double> layer_at(double zeta) const {
    const double place = 0.5 * (zeta / core + 1.0) * layers();
    const int layer = std::clamp(static_cast<int>(place), 0, layers() - 1);
    return {layer, place - layer};
  }
  [[nodiscard]] Vec2 core_m(double share, double zeta) const {
    const auto [layer, up] = layer_at(zeta);
    const Vec2 corner_m = (1.0 - up) * corners_m_[layer] + up * corners_m_[layer + 1];
    return {share * corner_m.x(), corner_m.y()};
  }

  Revolution shape_;
  Cuts cuts_;
  double bottom_m_;
  std::vector<Vec2> corners_m_;  // of the core, from the bottom up
};

/// A square within [-1,1]^2 keeps its shape, the border becomes the unit circle.
constexpr double inner_square = 0.5;

Vec2 on_circle(const Vec2& on_square) {
  const Vec2 sign(std::copysign(1.0, on_square.x()), std::copysign(1.0, on_square.y()));
  const Vec2 size = on_square.cwiseAbs();
  const bool x_side = size.x() >= size.y();
  const double angle = 0.5 * right_angle * (x_side ? size.y() / size.x() : size.x() / size.y());
  const Vec2 direction = x_side ? Vec2(std::cos(angle), std::sin(angle)) : Vec2(std::sin(angle), std::cos(angle));
  return sign.cwiseProduct(direction);
}

Vec2 on_disc(const Vec2& in_square) {
  const double q = in_square.cwiseAbs().maxCoeff();
  if (q <= inner_square) return in_square;
  const double outward = (q - inner_square) / (1.0 - inner_square);
  return (1.0 - outward) * inner_square / q * in_square + outward * on_circle(in_square);
}

Eigen::Vector3d place_m(const Meridian& meridian, const Vec2& stretch, const Eigen::Vector3d& x) {
  const Vec2 across = x.head<2>();
  const double q = across.cwiseAbs().maxCoeff(), width = std::max(core, std::abs(x.z()));
  Vec2 direction;
  Vec2 rz_m;
  if (q <= width) {
    const Vec2 disc = on_disc(across / width);
    const double share = disc.norm();
    direction = share > 0.0 ? Vec2(disc / share) : Vec2::UnitX();
    rz_m = meridian.place_m(std::min(share, 1.0) * width, x.z());
  } else {
    direction = on_circle(across);
    rz_m = meridian.place_m(q, x.z());
  }
  return {stretch.x() * rz_m.x() * direction.x(), stretch.y() * rz_m.x() * direction.y(), rz_m.y()};
}

/// Cells of the half-plane's grid by their corners (q, zeta), lexicographic. Those at the axis come first.
struct HalfPlane {
  using Quad = std::array<Vec2, 4>;
  std::vector<Quad> columns, sides;
};

HalfPlane half_plane(int layers) {
  HalfPlane plane;
  const auto zeta = [&](int ring) { return core * (2.0 * ring / layers - 1.0); };
  for (int j = 0; j < layers; ++j) {
    plane.columns.push_back({Vec2(0.0, zeta(j)), {core, zeta(j)}, {0.0, zeta(j + 1)}, {core, zeta(j + 1)}});
  }
  for (int layer = 0; layer < shell_layers; ++layer) {
    const double in = core + (1.0 - core) * layer / shell_layers;
    const double out = core + (1.0 - core) * (layer + 1) / shell_layers;
    plane.columns.push_back({Vec2(0.0, in), {in, in}, {0.0, out}, {out, out}});
    plane.columns.push_back({Vec2(0.0, -out), {out, -out}, {0.0, -in}, {in, -in}});
    for (int j = 0; j < layers; ++j) {
      const double low = zeta(j) / core, high = zeta(j + 1) / core;
      plane.sides.push_back({Vec2(in, in * low), {out, out * low}, {in, in * high}, {out, out * high}});
    }
  }
  return plane;
}

/// Collects cells given by their corners' places.
template <int dim>
class Collector {
 public:
  using Point = Eigen::Matrix<double, dim, 1>;
  explicit Collector(MappedSpec<dim>& spec) : spec_(spec) {}
  void add(const std::array<Point, 1 << dim>& corners) {
    auto& cell = spec_.cells.emplace_back();
    for (std::size_t v = 0; v < corners.size(); ++v) {
      std::array<long, dim> key;
      for (int d = 0; d < dim; ++d) key[d] = std::lround(1e9 * corners[v][d]);
      const auto [entry, fresh] = numbers_.try_emplace(key, static_cast<int>(spec_.vertices.size()));
      if (fresh) spec_.vertices.push_back(corners[v]);
      cell[v] = entry->second;
    }
  }

 private:
  MappedSpec<dim>& spec_;
  std::map<std::array<long, dim>, int> numbers_;
};

void add_cells(const HalfPlane& plane, const RoundSpec&, Collector<2>& to) {
  for (const auto& quad : plane.columns) to.add(quad);
  for (const auto& quad : plane.sides) to.add(quad);
}

void add_cells(const HalfPlane& plane, const RoundSpec& spec, Collector<3>& to) {
  constexpr double s = inner_square;
  // Of one quadrant, lexicographic: the disc's inner square and its ring, and the two stretches of the circle.
  const std::array<std::array<Vec2, 4>, 3> disc{{{Vec2(0.0, 0.0), {s, 0.0}, {0.0, s}, {s, s}},
                                                 {Vec2(s, 0.0), {1.0, 0.0}, {s, s}, {1.0, 1.0}},
                                                 {Vec2(0.0, s), {s, s}, {0.0, 1.0}, {1.0, 1.0}}}};
  const std::array<std::array<Vec2, 2>, 2> circle{{{Vec2(1.0, 0.0), {1.0, 1.0}}, {Vec2(1.0, 1.0), {0.0, 1.0}}}};
  for (const double sign_x : {1.0, -1.0}) {
    for (const double sign_y : {1.0, -1.0}) {
      if ((sign_x < 0.0 && spec.symmetric_x) || (sign_y < 0.0 && spec.symmetric_y)) continue;
      const auto add = [&](const auto& corner) {  // corner(v): (across, zeta)
        std::array<Eigen::Vector3d, 8> corners;
        for (int v = 0; v < 8; ++v) {
          // A mirrored cell is right-handed again with its first direction turned.
          corners[v] = corner(sign_x * sign_y < 0.0 ? v ^ 1 : v);
          corners[v].x() *= sign_x;
          corners[v].y() *= sign_y;
        }
        to.add(corners);
      };
      for (const auto& quad : plane.columns) {
        for (const auto& piece : disc) {
          add([&](int v) {
            const Vec2& edge = quad[v < 4 ? 1 : 3];  // (half width, zeta)
            return Eigen::Vector3d(edge.x() * piece[v % 4].x(), edge.x() * piece[v % 4].y(), edge.y());
          });
        }
      }
      for (const auto& quad : plane.sides) {
        for (const auto& piece : circle) {
          add([&](int v) {
            const Vec2& corner = quad[v % 2 + (v < 4 ? 0 : 2)];
            const Vec2& around = piece[v / 2 % 2];
            return Eigen::Vector3d(corner.x() * around.x(), corner.x() * around.y(), corner.y());
          });
        }
      }
    }
  }
}

}  // namespace

RoundSpec round_spec(const scene::Body& body) {
  RoundSpec spec;
  spec.support_height_m = body.flat_bottom() ? 0.0 : body.support_height_m;
  scene::TurnedForm form = scene::kind_of(body).turned(body);
  spec.profile = std::move(form.profile);
  spec.stretch = form.stretch;
  return spec;
}

Vec2 support_edge_m(const RoundSpec& spec) {
  const Revolution shape(spec.profile);
  const Ring ring = shape.flat_bottom() ? Ring{0, 1.0} : ring_at(shape, spec.support_height_m);
  return shape.meridian(ring.piece, ring.share).rz_m - Vec2(0.0, shape.piece(0).start_m.y());
}

std::string round_fault(const RoundSpec& spec) {
  constexpr double smallest_share = 0.02;  // of the whole profile's length
  const Revolution shape(spec.profile);
  const Cuts cuts = cut(shape, spec.support_height_m);
  double whole_m = 0.0;
  for (int k = 0; k < shape.piece_count(); ++k) whole_m += shape.piece(k).length_m;
  std::vector<Section> sections{cuts.bottom, cuts.top};
  sections.insert(sections.end(), cuts.sides.begin(), cuts.sides.end());
  const double top_m = shape.meridian(cuts.top.piece, cuts.top.begin).rz_m.y() - shape.piece(0).start_m.y();
  if (support_edge_m(spec).y() >= top_m) {
    return fmt::format("the support's edge lies on the body's top; expected it below {:.4g} m, found {:.4g} m", top_m,
                       support_edge_m(spec).y());
  }
  for (const Section& section : sections) {
    const double share = length_m(shape, section) / whole_m;
    if (share >= smallest_share) continue;
    const double z_m = shape.meridian(section.piece, section.begin).rz_m.y() - shape.piece(0).start_m.y();
    return fmt::format(
        "between the corners, joints and the support's edge the reference needs {:g} of the profile's length "
        "everywhere, not {:g} at z = {:g} m",
        smallest_share, share, z_m);
  }
  return {};
}

template <int dim>
MappedSpec<dim> round_cells(const RoundSpec& spec) {
  const Meridian meridian(spec);
  MappedSpec<dim> mapped;
  Collector<dim> collector(mapped);
  add_cells(half_plane(meridian.layers()), spec, collector);
  // The mesh keeps the map, to be refined by.
  mapped.place_m = [meridian, stretch = spec.stretch](const Eigen::Matrix<double, dim, 1>& x) {
    if constexpr (dim == 3) {
      return place_m(meridian, stretch, x);
    } else {
      const Vec2 rz_m = meridian.place_m(x[0], x[1]);
      return Vec2(stretch.x() * rz_m.x(), rz_m.y());
    }
  };
  const double held_m = spec.support_height_m + 1e-9 * meridian.shape().bounds().upper_m.x();
  mapped.boundary = [spec, held_m, place_m = mapped.place_m](const Eigen::Matrix<double, dim, 1>& middle) {
    constexpr double in_plane = 1e-9;
    if (std::abs(middle[0]) < in_plane && (dim == 2 || spec.symmetric_x)) return Boundary::plane_x;
    if (dim == 3 && std::abs(middle[1]) < in_plane && spec.symmetric_y) return Boundary::plane_y;
    return place_m(middle)[dim - 1] <= held_m ? Boundary::held : Boundary::free;
  };
  return mapped;
}

template <int dim>
Discretisation<dim> round_mesh(const RoundSpec& spec, const Grading<dim>& grading) {
  MappedSpec<dim> mapped = round_cells<dim>(spec);
  mapped.grading = grading;
  return mapped_mesh(mapped);
}

template MappedSpec<2> round_cells(const RoundSpec&);
template MappedSpec<3> round_cells(const RoundSpec&);

template Discretisation<2> round_mesh(const RoundSpec&, const Grading<2>&);
template Discretisation<3> round_mesh(const RoundSpec&, const Grading<3>&);

}  // namespace touchstone::reference
