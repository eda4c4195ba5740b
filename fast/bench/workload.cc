#include "fast/bench/workload.h"

#include "scene/base/error.h"
#include "scene/base/index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <utility>

namespace touchstone::bench {
namespace {

using scene::BodyShape;
using scene::Vec3;

constexpr double one_ball_radius_m = 0.010, small_ball_radius_m = 0.004;
constexpr double box_edge_m = 0.06;
const Vec3 semi_axes_m(0.040, 0.030, 0.025);
/// As on the ball of 10 mm with 2000 samples: 0.79 mm between neighbours.
constexpr double samples_per_m2 = 2000.0 / (4.0 * std::numbers::pi * one_ball_radius_m * one_ball_radius_m);

constexpr std::array<std::pair<const char*, int>, 4> sizes = {
    {{"1k", 1000}, {"4k", 3952}, {"20k", 20000}, {"100k", 100000}}};

double top_m(const Case& which) { return which.body == BodyShape::box ? box_edge_m : 2.0 * semi_axes_m.z(); }

struct Foot {
  Vec3 point_m, normal;
};

/// Point of the body's top surface above (x, y).
Foot foot(const Case& which, const Eigen::Vector2d& place_m) {
  if (which.body == BodyShape::box) return {{place_m.x(), place_m.y(), box_edge_m}, Vec3::UnitZ()};
  const Vec3& a = semi_axes_m;
  const double x = place_m.x() / a.x(), y = place_m.y() / a.y();
  const double z = std::sqrt(1.0 - x * x - y * y);
  return {{place_m.x(), place_m.y(), a.z() * (1.0 + z)}, Vec3(x / a.x(), y / a.y(), z / a.z()).normalized()};
}

/// Tool height at first touch: a mesh has its origin at its tip, a ball at its centre.
double height_at_touch_m(const Case& which) { return top_m(which) + (which.regions == 1 ? one_ball_radius_m : 0.0); }

double depth_m(const Case& which) { return which.regions == 1 ? 0.0025 : 0.0022; }

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts;
  std::istringstream in(name);
  for (std::string part; std::getline(in, part, '/');) parts.push_back(part);
  return parts;
}

struct Icosphere {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

Icosphere icosphere(int halvings) {
  const double t = std::numbers::phi;
  Icosphere ball;
  ball.points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                 {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (Vec3& p : ball.points) p.normalize();
  ball.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < halvings; ++i) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(ball.points.size()));
      if (is_new) {
        const Vec3 m = (nth(ball.points, a) + nth(ball.points, b)).normalized();
        ball.points.push_back(m);
      }
      return entry->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : ball.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    ball.triangles = std::move(finer);
  }
  return ball;
}

}  // namespace

std::string Case::name() const {
  return std::string(response                 ? "response"
                     : body == BodyShape::box ? "box"
                                              : "ellipsoid") +
         "/" + size + "/" + std::to_string(regions);
}

int triangles_wished(const std::string& size) {
  for (const auto& [name, triangles] : sizes) {
    if (size == name) return triangles;
  }
  throw scene::InputError("no size '" + size + "' in the benchmark; expected 1k, 4k, 20k or 100k");
}

std::vector<Case> all_cases(bool quick) {
  std::vector<Case> cases;
  for (const BodyShape body : {BodyShape::box, BodyShape::ellipsoid}) {
    for (const auto& [size, triangles] : sizes) {
      if (quick && std::string(size) == "20k") continue;
      for (const int regions : {1, 2, 5, 10}) {
        if (!quick || regions == 1 || regions == 10) cases.push_back({body, size, regions});
      }
    }
  }
  for (const auto& [size, triangles] : sizes) {
    if (!quick || std::string(size) != "20k") cases.push_back({BodyShape::box, size, 1, true});
  }
  return cases;
}

bool matches(const std::string& name, const std::string& pattern) {
  const std::vector<std::string> have = parts_of(name), want = parts_of(pattern);
  if (want.size() > have.size()) return false;
  for (std::size_t i = 0; i < want.size(); ++i) {
    if (want[i] != "*" && want[i] != have[i]) return false;
  }
  return true;
}

scene::TriangleMesh balls_mesh(const std::vector<Vec3>& centers_m, double radius_m, int halvings) {
  const Icosphere ball = icosphere(halvings);
  const auto vertices = static_cast<Eigen::Index>(ball.points.size());
  scene::TriangleMesh mesh;
  mesh.points_m.resize(3, vertices * static_cast<Eigen::Index>(centers_m.size()));
  Eigen::Index next = 0;
  for (const Vec3& center_m : centers_m) {
    const auto first = static_cast<std::int32_t>(next);
    for (const Vec3& p : ball.points) mesh.points_m.col(next++) = center_m + radius_m * p;
    for (const auto& [a, b, c] : ball.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  }
  return mesh;
}

std::vector<Eigen::Vector2d> contact_places_m(int regions) {
  // Ordered so that the first two and the first five are spread as well.
  constexpr double x = 0.0065, y = 0.014;
  const std::array<Eigen::Vector2d, 10> all = {{{-2 * x, 0},
                                                {2 * x, 0},
                                                {-x, y},
                                                {3 * x, y},
                                                {x, -y},
                                                {x, y},
                                                {-3 * x, y},
                                                {-x, -y},
                                                {3 * x, -y},
                                                {-3 * x, -y}}};
  return {all.begin(), all.begin() + std::clamp(regions, 0, static_cast<int>(all.size()))};
}

scene::Scene scene_of(const Case& which) {
  scene::Scene scene;
  scene.name = "bench";
  scene.title = "Benchmark " + which.name();
  scene.body.shape = which.body;
  scene.body.material = {3.0e6, 0.5};
  if (which.body == BodyShape::box) {
    scene.body.size_m = Vec3::Constant(box_edge_m);
  } else {
    scene.body.semi_axes_m = semi_axes_m;
    scene.body.support_height_m = 0.005;
  }
  scene.tool.mass_kg = 1.0;
  if (which.regions == 1) {
    scene.tool.shape = scene::ToolShape::sphere;
    scene.tool.radius_m = one_ball_radius_m;
  } else {
    std::vector<Vec3> centers_m;
    for (const Eigen::Vector2d& place_m : contact_places_m(which.regions)) {
      const Foot at = foot(which, place_m);
      centers_m.emplace_back(at.point_m + small_ball_radius_m * at.normal - Vec3(0, 0, top_m(which)));
    }
    scene.tool.shape = scene::ToolShape::mesh;
    scene.tool.mesh = std::make_shared<const scene::TriangleMesh>(balls_mesh(centers_m, small_ball_radius_m, 2));
    scene.tool.mass_center_m = Vec3::Zero();
  }
  const double radius_m = which.regions == 1 ? one_ball_radius_m : small_ball_radius_m;
  scene.fast.tool_samples =
      static_cast<int>(std::lround(which.regions * samples_per_m2 * 4.0 * std::numbers::pi * radius_m * radius_m));
  scene.contact.k1_n_per_m = 40.0;
  scene.contact.k3_n_per_m3 = 3.0e8;
  scene.fast.formulation = which.response ? scene::Formulation::response : scene::Formulation::corrected;
  scene.fast.triangles = triangles_wished(which.size);
  scene.fast.max_regions = which.regions;
  scene.fast.rate_hz = 1000.0;
  scene.contact.r_th_m = 0.004;
  scene.fast.r_R_m = 0.015;
  scene.fast.C_n = 0.2;
  scene.fast.C_r_m = 0.002;
  scene.fast.s_c_m2 = 1.0e-3;
  scene.compare.instants = 2;
  scene.track = {{0.0, pose_at_tick(which, 0)}, {1.0, pose_at_tick(which, approach_ticks)}};
  return scene;
}

scene::Response made_up_response(const scene::Scene& scene, const scene::Surface& surface) {
  constexpr double own_m_per_n = 2e-5;
  scene::Response out;
  out.grid = scene::load_grid(scene).grid.value();
  out.loads = scene::load_kinds(scene);
  const int columns = out.loads.columns(out.grid.count());
  out.smooth_m_per_n.setConstant(3 * surface.points_m.cols(), columns, static_cast<float>(0.1 * own_m_per_n));
  out.own_m_per_n.setZero(3, columns);
  out.own_m_per_n.leftCols(out.grid.count()) = -own_m_per_n * out.grid.normals;
  out.tilt_per_n.setZero(2, out.grid.count());
  return out;
}

scene::Pose pose_at_tick(const Case& which, std::int64_t tick) {
  constexpr double apart_m = 0.0005, sway_m = 0.0002;
  const double way_in = std::min(1.0, static_cast<double>(tick) / static_cast<double>(approach_ticks));
  const auto wave = [tick](int period) {
    return sway_m * std::sin(2.0 * std::numbers::pi * static_cast<double>(tick - approach_ticks) / period);
  };
  const bool swaying = tick > approach_ticks;
  const double depth = -apart_m + way_in * (depth_m(which) + apart_m) + (swaying ? wave(97) : 0.0);
  const double height_m = height_at_touch_m(which) - depth;
  return {{swaying ? wave(61) : 0.0, swaying ? wave(83) : 0.0, height_m}, Eigen::Quaterniond::Identity()};
}

}  // namespace touchstone::bench
