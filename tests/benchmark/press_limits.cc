// Force of 960 presses against its limit of ever smaller pieces of surface: six tools of 1e-3 to 1e3 times the body's
// size, on four bodies, at four places. Prints a row for each and how many are within 1 %.
#include "fast/contact/rest_distance.h"
#include "fast/step/cell_rule.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "support/press.h"
#include "support/tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Above the body: places relative to half its bounds.
struct Place {
  std::string_view name;
  Vec3 rel;
};
const std::array<Place, 4> places{
    {{"top", {0, 0, 1.2}}, {"aside", {0.36, 0.6, 1.2}}, {"edge", {1.2, 0, 1.2}}, {"corner", {1.2, 1.2, 1.2}}}};

/// How far the tool's surface is from its mass centre, that way.
double reach_m(const ToolSamples& tool, const Vec3& way) {
  double reach = 0.0;
  for (const SurfaceCell& cell : tool.cell) {
    // The finest cells around the ray decide.
    std::vector<SurfaceCell> now{cell};
    for (int round = 0; round < 40 && !now.empty() && now.size() < 64; ++round) {
      std::vector<SurfaceCell> next;
      for (const SurfaceCell& here : now) {
        const double along_m = here.center_T_m.dot(way);
        if (along_m <= 0.0 || (here.center_T_m - along_m * way).norm() > here.radius_m) continue;
        for (const SurfaceCell& half : halves(here, tool.groups)) next.push_back(half);
      }
      if (next.empty()) break;
      now = std::move(next);
    }
    for (const SurfaceCell& here : now) {
      const double along_m = here.center_T_m.dot(way);
      const double facing = here.normal_T.dot(way);
      if (along_m <= 0.0 || (here.center_T_m - along_m * way).norm() > here.radius_m || facing < 1e-6) continue;
      // Where the ray meets the piece's tangent plane.
      reach = std::max(reach, here.center_T_m.dot(here.normal_T) / facing);
    }
  }
  return reach;
}

/// Pieces of the tool's surface that are inside, each so small that it is in or out as a whole.
struct Piece {
  Vec3 p_T_m, area_T_m2;  ///< normal times area
  double depth_m;         ///< to the rest surface
  Vec3 rest_normal_W;
  double curvature_per_m;
};

std::vector<Piece> pieces_inside(const FastModel& model, const Placement& at, std::size_t least) {
  std::vector<SurfaceCell> now(model.tool.cell), near;
  const auto place = [&](const SurfaceCell& cell) {
    return model.body->query(at.R_WT * cell.center_T_m + at.origin_W_m);
  };
  for (int round = 0; round < 60; ++round) {
    near.clear();
    std::size_t inside = 0;
    for (const SurfaceCell& cell : now) {
      const double distance_m = place(cell).signed_distance_m;
      if (distance_m < cell.radius_m) near.push_back(cell);
      inside += distance_m < 0.0 && cell.group < 0;
    }
    if (near.empty() || inside >= least || near.size() > 40 * least) break;
    now.clear();
    for (const SurfaceCell& cell : near) {
      for (const SurfaceCell& half : halves(cell, model.tool.groups)) now.push_back(half);
    }
  }
  // Those on the border are divided further.
  std::vector<std::pair<SurfaceCell, int>> open;
  for (const SurfaceCell& cell : near) open.emplace_back(cell, 0);
  std::vector<Piece> pieces;
  while (!open.empty()) {
    const auto [cell, halvings] = open.back();
    open.pop_back();
    const scene::SurfaceQuery rest = place(cell);
    if (rest.signed_distance_m >= cell.radius_m) continue;
    const bool border = rest.signed_distance_m > -cell.radius_m;
    if ((cell.group >= 0 && halvings < 40) || (border && halvings < 6)) {
      for (const SurfaceCell& half : halves(cell, model.tool.groups)) open.emplace_back(half, halvings + 1);
      continue;
    }
    if (rest.signed_distance_m >= 0.0) continue;
    const double curvature_per_m = model.tool.mean_curvature_per_m.empty()
                                       ? -1.0
                                       : model.tool.mean_curvature_per_m[static_cast<std::size_t>(cell.sample)];
    pieces.push_back(
        {cell.center_T_m, cell.area_m2 * cell.normal_T, -rest.signed_distance_m, rest.normal, curvature_per_m});
  }
  return pieces;
}

/// The mean depth by the mass shares: the force of a law of 1 N per metre.
double mean_depth_m(const FastModel& model, const Placement& at, const std::vector<Piece>& pieces, bool curved) {
  Vec3 sum_W = Vec3::Zero();
  for (const Piece& piece : pieces) {
    const Vec3 area_W_m2 = at.R_WT * piece.area_T_m2;
    // The same integral by the divergence theorem, exact for one direction of d where the tool is a ball.
    sum_W += curved ? Vec3((piece.depth_m * piece.rest_normal_W.dot(area_W_m2.normalized()) -
                            piece.depth_m * piece.depth_m * piece.curvature_per_m) *
                           area_W_m2)
                    : Vec3(piece.depth_m * area_W_m2.norm() * piece.rest_normal_W);
  }
  const Vec3 d = -sum_W.normalized(), d_T = at.R_WT.transpose() * d;
  double shares = 0.0, depths = 0.0;
  for (const Piece& piece : pieces) {
    const double projected_m2 = piece.area_T_m2.dot(d_T);
    if (!(projected_m2 > 0.0)) continue;
    const Vec3 r_m = piece.p_T_m - piece.p_T_m.dot(d_T) * d_T;
    const double share =
        projected_m2 * mean_inverse_distance_per_m(r_m.squaredNorm(), std::sqrt(projected_m2 / std::numbers::pi));
    shares += share;
    depths += share * model.detection.exit_distance_m(*model.body, at.R_WT * piece.p_T_m + at.origin_W_m, -d);
  }
  return shares > 0.0 ? depths / shares : 0.0;
}

struct Limit {
  double force_n, change_rel;  ///< from a quarter of the pieces, over three: what is left
};

Limit limit_of(const FastModel& model, const scene::Pose& pose, std::size_t pieces) {
  const Placement at = placement(pose);
  const bool curved = !model.tool.mean_curvature_per_m.empty();
  const double coarse = mean_depth_m(model, at, pieces_inside(model, at, pieces), curved),
               fine = mean_depth_m(model, at, pieces_inside(model, at, 4 * pieces), curved);
  const double limit = (4.0 * fine - coarse) / 3.0;
  return {limit, (fine - coarse) / 3.0 / limit};
}

int run(std::size_t pieces, std::string_view only) {
  std::map<std::string, std::array<int, 2>> within;
  double worst = 0.0;
  for (const test::NamedBody& body : test::four_bodies()) {
    for (const Place& place : places) {
      for (const double ratio : {1e-3, 1e-2, 0.1, 0.3, 0.5, 1.0, 3.0, 10.0, 100.0, 1000.0}) {
        for (const test::NamedTool& tool : test::tools(0.03 * ratio)) {
          const std::string name = fmt::format("{}, {}, {:g}, {}", body.name, place.name, ratio, tool.name);
          if (name.find(only) == std::string::npos) continue;
          scene::Scene scene = test::ball_on_cube();
          scene.body = body.body;
          scene.tool = tool.tool;
          scene.tool.mass_kg = 1.0;
          scene.contact.k1_n_per_m = 1.0;
          scene.contact.k3_n_per_m3 = 0.0;
          scene.fast.triangles = 400;
          const auto rest = scene::body_shape(scene.body);
          const scene::Bounds around = rest->bounds();
          const Vec3 half_m = 0.5 * (around.upper_m - around.lower_m);
          const scene::SurfaceQuery at = rest->query(around.lower_m + half_m + half_m.cwiseProduct(place.rel));
          const double deepest_m = std::min(0.002, 0.3 * 0.03 * ratio);
          const double touch_m = reach_m(cell_tool(scene.tool, scene.fast.tool_samples / 4), -at.normal);
          const auto pose_at = [&](double depth_m) {
            return scene::Pose{at.point_m + (touch_m - depth_m) * at.normal, Eigen::Quaterniond::Identity()};
          };
          scene.track = {{0.0, pose_at(-0.15 * deepest_m)}, {1.0, pose_at(deepest_m)}};
          const FastModel model = model_of(scene);
          FastState state(model);
          for (int k = -3; k <= 20; ++k) step_force(model, pose_at(deepest_m * k / 20.0), state);
          const double force_n = total_force_n(state).norm();
          const Limit limit = limit_of(model, scene.track.back().pose, pieces);
          const double error = force_n / limit.force_n - 1.0;
          const bool good = std::abs(error) <= 0.01;
          const std::string kind = tool.tool.shape == scene::ToolShape::mesh ? "meshes" : "primitive shapes";
          ++within[kind][1];
          within[kind][0] += good;
          worst = std::max(worst, std::abs(error));
          fmt::print("{:<40} {:>5} points, plan {:>5.2f} %, error {:>7.3f} %, limit known to {:>6.3f} % {}\n", name,
                     model.cells->rule.points, 100.0 * model.cells->error_rel, 100.0 * error,
                     100.0 * std::abs(limit.change_rel), good ? "" : "MORE THAN 1 %");
          std::fflush(stdout);
        }
      }
    }
  }
  for (const auto& [kind, count] : within) fmt::print("{}: {} of {} within 1 %\n", kind, count[0], count[1]);
  fmt::print("largest error {:.2f} %\n", 100.0 * worst);
  return 0;
}

}  // namespace
}  // namespace touchstone::fast

/// press_limits [PART_OF_A_NAME]
int main(int count, char** arguments) { return touchstone::fast::run(6000, count > 1 ? arguments[1] : ""); }
