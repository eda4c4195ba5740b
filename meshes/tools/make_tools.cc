// Writes the mesh tools of the shipped scenes and of the tutorial: mallet.stl, compass.obj, stylus.stl.
#include "scene/mesh/mesh_checks.h"
#include "scene/mesh/mesh_formats.h"
#include "scene/mesh/triangle_mesh.h"
#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>

namespace touchstone::scene {
namespace {

constexpr double mm = 1e-3, pi = std::numbers::pi;

/// Points of a curve in a half plane (r, z), in millimetres.
using Curve = std::vector<Eigen::Vector2d>;

/// A straight line from the last point, in steps of about `step`.
void line_to(Curve& curve, const Eigen::Vector2d& end, double step) {
  const Eigen::Vector2d start = curve.back();
  const int n = std::max(1, static_cast<int>(std::lround((end - start).norm() / step)));
  for (int k = 1; k <= n; ++k) curve.push_back(start + (end - start) * k / n);
}

/// A circular arc from one angle to another.
void arc(Curve& curve, const Eigen::Vector2d& center, double radius, double from, double to, double step) {
  const int n = std::max(2, static_cast<int>(std::lround(radius * std::abs(to - from) / step)));
  for (int k = 1; k <= n; ++k) {
    const double angle = from + (to - from) * k / n;
    curve.push_back(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
}

/// Rings of vertices above each other; a ring of no segments is a single vertex.
struct Rings {
  TriangleMesh mesh;
  std::vector<Vec3> points;
  std::vector<int> begin, segments;  ///< segments of a quarter

  void add(const std::vector<Vec3>& ring) {
    const int quarter = static_cast<int>(ring.size()) / 4;
    begin.push_back(static_cast<int>(points.size()));
    segments.push_back(quarter);
    points.insert(points.end(), ring.begin(), ring.end());
    if (begin.size() < 2) return;
    const std::size_t k = begin.size() - 2;
    for (int q = 0; q < 4; ++q) {
      const auto vertex = [&](std::size_t at, int i) {
        const int n = segments[at];
        return begin[at] + (n > 0 ? (q * n + i) % (4 * n) : 0);
      };
      join_rows(
          segments[k], segments[k + 1], static_cast<int>(k), [&](int i) { return vertex(k, i); },
          [&](int j) { return vertex(k + 1, j); },
          [&](int a, int b, int c) {
            mesh.triangles.push_back({a, b, c});
          });
    }
  }
  TriangleMesh finish() {
    mesh.points_m.resize(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) mesh.points_m.col(static_cast<Eigen::Index>(i)) = mm * points[i];
    return std::move(mesh);
  }
};

/// Segments of a quarter of a circle.
int quarter_segments(double radius, double step) {
  return radius < 1e-9 ? 0 : std::max(1, static_cast<int>(std::lround(0.5 * pi * radius / step)));
}

/// A surface of revolution about z.
/// @param step_at  length of the facets along the circle at a height
template <class Step>
TriangleMesh turned(const Curve& curve, const Step& step_at) {
  Rings rings;
  for (const Eigen::Vector2d& p : curve) {
    const int n = quarter_segments(p.x(), step_at(p.y()));
    std::vector<Vec3> ring;
    for (int i = 0; i < std::max(1, 4 * n); ++i) {
      const double angle = n > 0 ? 0.5 * pi * i / n : 0.0;
      const double r = n > 0 ? p.x() : 0.0;
      ring.push_back({r * std::cos(angle), r * std::sin(angle), p.y()});
    }
    rings.add(ring);
  }
  return rings.finish();
}

/// A disc-shaped head at the bottom, face down, and a round handle up to the tail: one surface of revolution.
TriangleMesh mallet() {
  constexpr double step = 1.2, tail_step = 0.4;
  constexpr double head_radius = 12.0, head_length = 25.0, head_edge = 3.0;
  constexpr double handle_radius = 4.0, handle_length = 70.0, neck = 2.0;
  const double top = head_length + handle_length;
  Curve curve{{0.0, 0.0}};
  line_to(curve, {head_radius - head_edge, 0.0}, step);
  arc(curve, {head_radius - head_edge, head_edge}, head_edge, -0.5 * pi, 0.0, step);
  line_to(curve, {head_radius, head_length - head_edge}, step);
  arc(curve, {head_radius - head_edge, head_length - head_edge}, head_edge, 0.0, 0.5 * pi, step);
  line_to(curve, {handle_radius + neck, head_length}, step);
  arc(curve, {handle_radius + neck, head_length + neck}, neck, 1.5 * pi, pi, step);
  // The tail is a half ball.
  line_to(curve, {handle_radius, top - handle_radius}, step);
  arc(curve, {0.0, top - handle_radius}, handle_radius, 0.0, 0.5 * pi, tail_step);
  return turned(curve, [=](double z) { return z < top - handle_radius ? step : tail_step; });
}

/// A straight rod with a half ball at either end, upright, its lower tip at z = 0.
TriangleMesh stylus() {
  constexpr double step = 2.0, tip_step = 0.8, radius = 5.0, length = 30.0;
  Curve curve{{0.0, 0.0}};
  arc(curve, {0.0, radius}, radius, -0.5 * pi, 0.0, tip_step);
  line_to(curve, {radius, length - radius}, step);
  arc(curve, {0.0, length - radius}, radius, 0.0, 0.5 * pi, step);
  return turned(curve, [=](double z) { return z <= radius ? tip_step : step; });
}

/// Two parallel pins, tips down at z = 0, joined by half a ring: a round tube along a U with a half ball at either end.
TriangleMesh compass() {
  constexpr double step = 1.0, tip_step = 0.25, radius = 2.5, half_apart = 12.0, pin_length = 30.0;
  // Arc length along the U: from the first tip's ball centre up, around and down.
  const double straight = pin_length - radius, around = pi * half_apart, length = 2.0 * straight + around;
  const auto frame = [&](double way, Vec3& center, Vec3& along) {
    if (way <= straight) {
      center = Vec3(half_apart, 0.0, radius + way);
      along = Vec3::UnitZ();
    } else if (way >= straight + around) {
      center = Vec3(-half_apart, 0.0, radius + length - way);
      along = -Vec3::UnitZ();
    } else {
      const double angle = (way - straight) / half_apart;
      center = Vec3(half_apart * std::cos(angle), 0.0, pin_length + half_apart * std::sin(angle));
      along = Vec3(-std::sin(angle), 0.0, std::cos(angle));
    }
  };
  // The profile over the arc length: half ball, tube, half ball.
  Curve curve{{0.0, -radius}};
  arc(curve, {0.0, 0.0}, radius, -0.5 * pi, 0.0, tip_step);
  line_to(curve, {radius, straight}, step);
  line_to(curve, {radius, straight + around}, step);
  line_to(curve, {radius, length}, step);
  arc(curve, {0.0, length}, radius, 0.0, 0.5 * pi, tip_step);
  Rings rings;
  for (const Eigen::Vector2d& p : curve) {
    Vec3 center, along;
    frame(p.y(), center, along);
    const Vec3 side = Vec3::UnitY().cross(along);
    const int n = quarter_segments(p.x(), p.y() <= 0.0 || p.y() >= length ? tip_step : step);
    std::vector<Vec3> ring;
    for (int i = 0; i < std::max(1, 4 * n); ++i) {
      const double angle = n > 0 ? 0.5 * pi * i / n : 0.0;
      const double r = n > 0 ? p.x() : 0.0;
      ring.push_back(center + r * (std::cos(angle) * side + std::sin(angle) * Vec3::UnitY()));
    }
    rings.add(ring);
  }
  return rings.finish();
}

void describe(const char* name, const TriangleMesh& mesh) {
  const Bounds b = mesh.bounds();
  std::printf("%s: %zu triangles, %s to %s m, volume %.6g m^3, mass centre %s m\n", name, mesh.triangles.size(),
              place_text(b.lower_m).c_str(), place_text(b.upper_m).c_str(), mesh.volume_m3(),
              place_text(mesh.centroid_m()).c_str());
}

}  // namespace
}  // namespace touchstone::scene

int main(int count, char** arguments) try {
  using namespace touchstone::scene;
  if (count != 2) {
    std::fprintf(
        stderr, "usage: touchstone-make-tools FOLDER\nwrites mallet.stl, compass.obj and stylus.stl, in millimetres\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  const TriangleMesh m = mallet(), c = compass(), s = stylus();
  write_stl(m, folder / "mallet.stl", mm);
  write_obj(c, folder / "compass.obj", mm);
  write_stl(s, folder / "stylus.stl", mm);
  describe("mallet.stl", m);
  describe("compass.obj", c);
  describe("stylus.stl", s);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
