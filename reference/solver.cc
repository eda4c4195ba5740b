#include "reference/solver.h"

#include "reference/contact_problem.h"
#include "reference/distance_grid.h"
#include "reference/load_path.h"
#include "reference/model_choice.h"
#include "reference/sampling.h"
#include "reference/store.h"
#include "reference/tool_distance.h"
#include "reference/uncertainty.h"
#include "scene/hash.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace touchstone::reference {
namespace {

using scene::Scene;
using Clock = std::chrono::steady_clock;

/// Raised with every change of method that moves a result; results of other versions are then not found.
constexpr const char* method_version = "touchstone reference 2: Q2-P1disc u-p, primal-dual active set";

/// Raised alike, for scenes with friction alone.
constexpr const char* friction_method = "1";

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string tool_text(const scene::Tool& tool) {
  std::ostringstream text;
  text << std::setprecision(17);
  switch (tool.shape) {
    case scene::ToolShape::sphere:
      text << "sphere " << tool.radius_m;
      break;
    case scene::ToolShape::capsule:
      text << "capsule " << tool.radius_m << ' ' << tool.length_m;
      break;
    case scene::ToolShape::cylinder:
      text << "cylinder " << tool.radius_m << ' ' << tool.length_m << ' ' << tool.edge_radius_m;
      break;
    case scene::ToolShape::box:
      text << "box " << tool.size_m.transpose() << " rounded by " << box_edge_share;
      break;
    case scene::ToolShape::mesh: {
      const scene::TriangleMesh& mesh = *tool.mesh;
      const auto bytes = [](const auto* data, auto count) {
        return std::string_view(reinterpret_cast<const char*>(data), count * sizeof *data);
      };
      text << "mesh " << scene::hash_text(bytes(mesh.points_m.data(), mesh.points_m.size())) << ' '
           << scene::hash_text(bytes(mesh.triangles.data(), mesh.triangles.size())) << " on a grid of "
           << grid_spacing_m(mesh);
      break;
    }
  }
  if (tool.mass_center_m) text << " mass centre " << tool.mass_center_m->transpose();
  return text.str();
}

void add_solid(const scene::Solid& solid, std::ostream& text) {
  switch (solid.shape) {
    case scene::BodyShape::box:
      text << "box " << solid.size_m.transpose();
      break;
    case scene::BodyShape::sphere:
      text << "sphere " << solid.radius_m;
      break;
    case scene::BodyShape::ellipsoid:
      text << "ellipsoid " << solid.semi_axes_m.transpose();
      break;
    case scene::BodyShape::revolution:
      text << "revolution";
      for (const Eigen::Vector2d& corner_m : solid.profile.rz_m) text << " (" << corner_m.transpose() << ')';
      for (const double radius_m : solid.profile.arc_radius_m) text << ' ' << radius_m;
      break;
  }
  text << '\n';
}

std::string identity_text(const Scene& scene) {
  std::ostringstream text;
  text << std::setprecision(17) << method_version << '\n';
  const auto add_material = [&](const scene::Material& material) {
    text << "E " << material.youngs_modulus_pa << " nu " << material.poissons_ratio << '\n';
  };
  text << "body ";
  add_solid(scene.body, text);
  if (!scene.body.flat_bottom()) text << "held below " << scene.body.support_height_m << '\n';
  add_material(scene.body.material);
  for (const scene::Inclusion& inclusion : scene.body.inclusions) {
    text << "inclusion at " << inclusion.center_m.transpose() << ' ';
    add_solid(inclusion, text);
    add_material(inclusion.material);
  }
  text << "tool " << tool_text(scene.tool) << '\n'
       << "regions " << scene.fast.r_th_m << " apart\n"
       << "kinematics " << (scene.reference.kinematics == scene::Kinematics::finite ? "finite" : "small") << " levels "
       << scene.reference.levels << " element "
       << (scene.reference.element_size_m ? std::to_string(*scene.reference.element_size_m * 1e9) + " nm" : "automatic")
       << '\n';
  if (const auto& friction = scene.contact.friction) {
    text << "friction " << friction_method << " K " << friction->K << " beta " << friction->beta << " mu_D "
         << friction->mu_D << '\n';
  }
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    text << "instant " << time_s << " tool at " << pose.position_m.transpose() << " turned "
         << pose.orientation.coeffs().transpose() << '\n';
  }
  return text.str();
}

/// What is kept of one solved instant besides its state.
struct Step {
  Observation seen;
  int unknowns = 0;
  int newton_iterations = 0;
  int halvings = 0;
  int indefinite = 0;
  double wall_s = 0.0;
  std::string linear_solver;
};

/// Friction's history, at the end of a record and only where there is one.
template <int dim>
void put_friction(const State<dim>& state, const Observation& seen, Record& record) {
  record.put(state.slipping.data(), state.slipping.size());
  record.put(state.sliding.data(), state.sliding.size());
  record.put(state.on_tool_m.data(), static_cast<std::size_t>(state.on_tool_m.size()));
  record.put(state.dissipated_j);
  for (const ContactRegion& region : seen.regions) {
    record.put(region.friction_n.data(), 3);
    record.put(region.stuck_share);
  }
}

template <int dim>
void take_friction(Record& record, int nodes, State<dim>& state, Observation& seen) {
  state.slipping.resize(nodes);
  state.sliding.resize(nodes);
  state.on_tool_m.resize(3, nodes);
  record.take(state.slipping.data(), state.slipping.size());
  record.take(state.sliding.data(), state.sliding.size());
  record.take(state.on_tool_m.data(), static_cast<std::size_t>(state.on_tool_m.size()));
  seen.dissipated_j = state.dissipated_j = record.take_double();
  for (ContactRegion& region : seen.regions) {
    record.take(region.friction_n.data(), 3);
    region.stuck_share = record.take_double();
  }
}

template <int dim>
Record to_record(const Solved<dim>& solved, const Step& step) {
  Record record;
  record.put(solved.time_s);
  record.put(solved.touching ? 1 : 0);
  record.put(static_cast<int>(solved.state.u_m.cols()));
  record.put(static_cast<int>(solved.state.p_pa.cols()));
  record.put(solved.state.u_m.data(), static_cast<std::size_t>(solved.state.u_m.size()));
  record.put(solved.state.p_pa.data(), static_cast<std::size_t>(solved.state.p_pa.size()));
  record.put(solved.state.touching.data(), solved.state.touching.size());
  record.put(step.seen.force_n.data(), 3);
  record.put(step.seen.torque_nm.data(), 3);
  record.put(step.seen.support_force_n.data(), 3);
  for (const double value :
       {step.seen.area_m2, step.seen.contact_radius_m, step.seen.node_penetration_m,
        step.seen.between_nodes_penetration_m, step.seen.equilibrium_rel, step.seen.volume_change_rel, step.wall_s}) {
    record.put(value);
  }
  for (const int value : {step.unknowns, step.newton_iterations, step.halvings, step.indefinite}) record.put(value);
  record.put(static_cast<int>(step.seen.regions.size()));
  for (const ContactRegion& region : step.seen.regions) {
    for (const scene::Vec3& vector : {region.force_n, region.torque_nm, region.center_m}) record.put(vector.data(), 3);
    record.put(region.area_m2);
  }
  record.put(std::string_view(step.linear_solver));
  if (solved.state.on_tool_m.cols() > 0) put_friction(solved.state, step.seen, record);
  return record;
}

/// @returns nothing when the record does not belong to this mesh
template <int dim>
std::optional<std::pair<Solved<dim>, Step>> from_record(Record record, const Mesh<dim>& mesh) {
  try {
    std::pair<Solved<dim>, Step> result;
    auto& [solved, step] = result;
    solved.time_s = record.take_double();
    solved.touching = record.take_int() != 0;
    if (record.take_int() != mesh.node_count() || record.take_int() != mesh.cell_count()) return std::nullopt;
    solved.state.u_m.resize(dim, mesh.node_count());
    solved.state.p_pa.resize(dim + 1, mesh.cell_count());
    solved.state.touching.resize(mesh.node_count());
    record.take(solved.state.u_m.data(), static_cast<std::size_t>(solved.state.u_m.size()));
    record.take(solved.state.p_pa.data(), static_cast<std::size_t>(solved.state.p_pa.size()));
    record.take(solved.state.touching.data(), solved.state.touching.size());
    record.take(step.seen.force_n.data(), 3);
    record.take(step.seen.torque_nm.data(), 3);
    record.take(step.seen.support_force_n.data(), 3);
    for (double* value : {&step.seen.area_m2, &step.seen.contact_radius_m, &step.seen.node_penetration_m,
                          &step.seen.between_nodes_penetration_m, &step.seen.equilibrium_rel,
                          &step.seen.volume_change_rel, &step.wall_s}) {
      *value = record.take_double();
    }
    for (int* value : {&step.unknowns, &step.newton_iterations, &step.halvings, &step.indefinite}) {
      *value = record.take_int();
    }
    for (int regions = record.take_int(); regions > 0; --regions) {
      ContactRegion& region = step.seen.regions.emplace_back();
      for (scene::Vec3* vector : {&region.force_n, &region.torque_nm, &region.center_m}) record.take(vector->data(), 3);
      region.area_m2 = record.take_double();
    }
    step.linear_solver = record.take_text();
    if (!record.at_end()) take_friction(record, mesh.node_count(), solved.state, step.seen);
    if (!record.at_end()) return std::nullopt;
    return result;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

/// Time left from the cost of the steps solved in this run. A step's cost is taken to grow like unknowns^1.7, between
/// assembly (1) and the factorisation in three dimensions (2).
class Estimate {
 public:
  explicit Estimate(double work) : work_left_(work) {}
  static double work_of(double unknowns) { return std::pow(unknowns, 1.7); }
  void solved(double work, double seconds) {
    work_left_ -= work;
    work_done_ += work;
    seconds_ += seconds;
  }
  void found(double work) { work_left_ -= work; }
  /// @param seconds_in_step  already spent on the step under way
  [[nodiscard]] double seconds_left(double seconds_in_step) const {
    if (work_done_ <= 0.0) return -1.0;
    return std::max(0.0, work_left_ * seconds_ / work_done_ - seconds_in_step);
  }

 private:
  double work_left_, work_done_ = 0.0, seconds_ = 0.0;
};

/// The depth of each region: of the one, the tool's; of several, that of the mesh's triangles nearest to each.
std::vector<double> region_depths_m(const Scene& scene, const scene::Shape& body, const scene::Pose& pose,
                                    const std::vector<ContactRegion>& regions) {
  const scene::Tool& tool = scene.tool;
  if (regions.size() < 2 || tool.shape != scene::ToolShape::mesh) {
    return std::vector<double>(regions.size(), scene::rest_depth_m(body, tool, pose));
  }
  const scene::TriangleMesh mesh = scene::tool_mesh(tool);
  std::vector<std::vector<std::array<std::int32_t, 3>>> parts(regions.size());
  for (const auto& t : mesh.triangles) {
    const scene::Vec3 middle_T_m = (mesh.points_m.col(t[0]) + mesh.points_m.col(t[1]) + mesh.points_m.col(t[2])) / 3.0;
    const scene::Vec3 middle_m = pose.orientation * middle_T_m + pose.position_m;
    const auto nearest = std::min_element(regions.begin(), regions.end(), [&](const auto& a, const auto& b) {
      return (a.center_m - middle_m).squaredNorm() < (b.center_m - middle_m).squaredNorm();
    });
    parts[nearest - regions.begin()].push_back(t);
  }
  std::vector<double> depths_m;
  for (const auto& part : parts) {
    // Loose triangles, so that no vertex is without one.
    scene::TriangleMesh piece;
    piece.points_m.resize(3, 3 * static_cast<Eigen::Index>(part.size()));
    for (const auto& t : part) {
      const auto first = static_cast<std::int32_t>(3 * piece.triangles.size());
      for (int k = 0; k < 3; ++k) piece.points_m.col(first + k) = mesh.points_m.col(t[k]);
      piece.triangles.push_back({first, first + 1, first + 2});
    }
    scene::Tool one = tool;
    one.mesh = std::make_shared<scene::TriangleMesh>(std::move(piece));
    one.mass_center_m = scene::Vec3::Zero();
    depths_m.push_back(scene::rest_depth_m(body, one, pose));
  }
  return depths_m;
}

/// One scene being answered. Levels and instants count from zero here, from one in everything shown.
template <int dim>
class Run {
 public:
  Run(const Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m, const Options& options)
      : scene_(scene),
        choice_(choice),
        options_(options),
        body_(scene::body_shape(scene.body)),
        times_s_(scene::instants_s(scene)),
        levels_(scene.reference.levels) {
    double work = 0.0;
    for (int level = 0; level < levels_; ++level) {
      meshes_.push_back(level_mesh<dim>(scene, choice, level));
      samplers_.emplace_back(meshes_.back(), rest_points_m, choice.mirror_x, choice.mirror_y);
      for (const double time_s : times_s_) work += work_at(level, time_s);
    }
    estimate_.emplace(work);
  }

  Result answer() {
    const std::string identity = identity_text(scene_);
    Store store(options_.store, identity, [&] {
      show({.instants = count(), .note = "another run is solving this scene; waiting for it"});
      check_stop();
    });
    Result result;
    result.model = choice_.name(scene_.reference.kinematics);
    result.key = Store::key(identity);
    result.from_store = true;

    std::vector<std::vector<double>> forces_n;
    std::vector<std::vector<Eigen::Matrix3Xd>> displacements_m;
    for (int level = 0; level < levels_; ++level) {
      std::vector<Step> steps;
      std::vector<Eigen::Matrix3Xd> shapes;
      solve_level(level, store, steps, shapes, result.from_store);
      LevelRecord record;
      record.element_size_m = element_size_m(scene_, choice_, level);
      for (const Step& step : steps) {
        record.unknowns = std::max(record.unknowns, step.unknowns);
        record.newton_iterations += step.newton_iterations;
        record.steps_cut += step.halvings;
        record.wall_s += step.wall_s;
        record.force_n.push_back(step.seen.force_n.norm());
        if (!step.linear_solver.empty()) result.linear_solver = step.linear_solver;
      }
      forces_n.push_back(record.force_n);
      result.levels.push_back(std::move(record));
      displacements_m.push_back(std::move(shapes));
      if (level + 1 == levels_) finish(steps, displacements_m.back(), result);
    }
    result.force_uncertainty_n = force_band(forces_n);
    result.displacement_uncertainty_m = displacement_band(displacements_m);
    if (result.from_store) show({.level = levels_, .instant = count(), .instants = count(), .note = "from the store"});
    return result;
  }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(times_s_.size()); }

  [[nodiscard]] double depth_m(double time_s) const {
    return scene::rest_depth_m(*body_, scene_.tool, scene::pose_at(scene_.track, time_s));
  }

  [[nodiscard]] double work_at(int level, double time_s) const {
    return depth_m(time_s) > 0.0 ? Estimate::work_of(dim * meshes_[level].node_count()) : 0.0;
  }

  void check_stop() const {
    if (options_.stop && options_.stop->load()) {
      throw Interrupted("interrupted; every finished load step is in the store and the next run goes on from there");
    }
  }

  void show(Progress progress) const {
    progress.levels = levels_;
    if (options_.progress) options_.progress(progress);
  }

  /// Reads what the store has and solves the rest, in track order.
  void solve_level(int level, const Store& store, std::vector<Step>& steps, std::vector<Eigen::Matrix3Xd>& shapes,
                   bool& all_stored) {
    const Mesh<dim>& mesh = meshes_[level];
    std::optional<ContactProblem<dim>> problem;  // only when something has to be solved
    std::optional<Solved<dim>> before, current;
    for (int instant = 0; instant < count(); ++instant) {
      const double time_s = times_s_[instant];
      check_stop();
      std::optional<std::pair<Solved<dim>, Step>> found;
      if (std::optional<Record> record = store.read(level, instant)) found = from_record<dim>(std::move(*record), mesh);
      if (found) {
        estimate_->found(work_at(level, time_s));
      } else {
        std::string note;
        if (instant > 0 && !problem && all_stored) {
          note = "resumed on mesh " + std::to_string(level + 1) + " at instant " + std::to_string(instant + 1);
        }
        all_stored = false;
        if (!problem) {
          problem.emplace(mesh, scene_.body.material, scene_.reference.kinematics, choice_.mirror_x, choice_.mirror_y);
          if (scene_.contact.friction) problem->set_friction(*scene_.contact.friction, scene_.fast.r_th_m);
        }
        if (!note.empty()) show({.level = level + 1, .instant = instant + 1, .instants = count(), .note = note});
        found = solve_instant(*problem, level, instant, before, current);
        store.write(level, instant, to_record(found->first, found->second));
        estimate_->solved(work_at(level, time_s), found->second.wall_s);
        show({.level = level + 1,
              .instant = instant + 1,
              .instants = count(),
              .depth_m = depth_m(time_s),
              .newton = found->second.newton_iterations,
              .unknowns = found->second.unknowns,
              .seconds_left = estimate_->seconds_left(0.0),
              .step_finished = true});
      }
      shapes.push_back(samplers_[level].displacement_m(found->first.state.u_m));
      steps.push_back(std::move(found->second));
      before = std::move(current);
      current = std::move(found->first);
    }
  }

  std::pair<Solved<dim>, Step> solve_instant(ContactProblem<dim>& problem, int level, int instant,
                                             const std::optional<Solved<dim>>& before,
                                             const std::optional<Solved<dim>>& current) {
    const double time_s = times_s_[instant];
    const Clock::time_point begin = Clock::now();
    std::pair<Solved<dim>, Step> result{{time_s, problem.rest(), false}, {}};
    auto& [solved, step] = result;
    step.unknowns = problem.unknowns();
    Progress progress{.level = level + 1,
                      .instant = instant + 1,
                      .instants = count(),
                      .depth_m = depth_m(time_s),
                      .unknowns = problem.unknowns()};
    const auto tool = [&](double t) { return RigidTool<dim>(choice_.tool, scene::pose_at(scene_.track, t)); };
    LoadPath<dim> path(
        problem,
        [&](double t) -> std::optional<RigidTool<dim>> {
          if (depth_m(t) <= 0.0) return std::nullopt;
          return tool(t);
        },
        tool);
    // A track that starts in contact is entered from rest, a moment before its first instant.
    const double lead_s = times_s_.size() > 1 ? times_s_[1] - times_s_[0] : 1.0;
    const Solved<dim> from = current ? *current : Solved<dim>{time_s - lead_s, problem.rest(), false};
    const AdvanceReport report = path.advance(
        before ? &*before : nullptr, from, time_s, solved,
        [&](int iteration, double residual_rel) {
          progress.newton = iteration;
          progress.residual_rel = residual_rel;
          progress.seconds_left = estimate_->seconds_left(seconds_since(begin));
          show(progress);
          check_stop();
        },
        [&](double failed_s) {
          std::ostringstream note;
          note << "load step halved at t = " << failed_s << " s";
          Progress halved = progress;
          halved.note = note.str();
          show(halved);
        });
    if (!report.converged) throw NotConverged(not_converged_text(level, instant, report));
    if (solved.touching) {
      step.seen = problem.observe(solved.state, scene_.fast.r_th_m);
      step.linear_solver = problem.linear_solver();
    }
    step.newton_iterations = report.newton_iterations;
    step.halvings = report.halvings;
    step.indefinite = report.indefinite;
    step.wall_s = seconds_since(begin);
    return result;
  }

  [[nodiscard]] std::string not_converged_text(int level, int instant, const AdvanceReport& report) const {
    std::ostringstream text;
    text << "instant " << instant + 1 << " of " << count() << " (t = " << times_s_[instant] << " s, depth "
         << depth_m(times_s_[instant]) << " m) did not converge on level " << level + 1 << ": " << report.last.trouble
         << ", residual " << report.last.residual_rel
         << " of the acting forces (asked: " << ContactProblem<dim>::force_tolerance
         << "), stuck at t = " << report.stuck_time_s << " s after " << report.halvings
         << " halvings. Finished steps are kept. Try a smaller reference.element_size_m (now "
         << element_size_m(scene_, choice_, 0) << " m on the coarsest level), more instants, or less depth.";
    return text.str();
  }

  /// The finest level's records.
  void finish(const std::vector<Step>& steps, const std::vector<Eigen::Matrix3Xd>& shapes, Result& result) const {
    int indefinite = 0;
    RegionIds ids;
    for (int instant = 0; instant < count(); ++instant) {
      const Observation& seen = steps[instant].seen;
      scene::InstantRecord record;
      record.time_s = times_s_[instant];
      record.tool = scene::pose_at(scene_.track, record.time_s);
      record.depth_m = depth_m(record.time_s);
      record.support_force_n = seen.support_force_n;
      record.displacement_m = shapes[instant];
      add_regions(seen.regions, instant, ids, record);
      result.instants.push_back(std::move(record));
      std::vector<scene::Vec3>& middles_m = result.region_middles_m.emplace_back();
      for (const ContactRegion& region : seen.regions) middles_m.push_back(region.center_m);
      result.residual_penetration_m.push_back(seen.node_penetration_m);
      result.between_nodes_penetration_m.push_back(seen.between_nodes_penetration_m);
      result.equilibrium_rel.push_back(seen.equilibrium_rel);
      result.volume_change_rel.push_back(seen.volume_change_rel);
      indefinite += steps[instant].indefinite;
    }
    if (indefinite > 0) {
      result.linear_solver +=
          "; " + std::to_string(indefinite) +
          " tangents were not positive definite and went without the tool's curvature or to UMFPACK";
    }
  }

  /// A region's centre moves no farther than the tool there, and a little.
  void add_regions(const std::vector<ContactRegion>& regions, int instant, RegionIds& ids,
                   scene::InstantRecord& record) const {
    double reach_m = scene_.fast.r_th_m;
    if (instant > 0) {
      const scene::Pose before = scene::pose_at(scene_.track, times_s_[instant - 1]);
      double lever_m = 0.0;
      for (const ContactRegion& region : regions) {
        lever_m = std::max(lever_m, (region.center_m - record.tool.position_m).norm());
      }
      reach_m += (record.tool.position_m - before.position_m).norm() +
                 lever_m * record.tool.orientation.angularDistance(before.orientation);
    }
    const std::vector<double> depths_m = region_depths_m(scene_, *body_, record.tool, regions);
    for (const RegionIds::Place& place : ids.follow(regions, reach_m)) {
      const ContactRegion& region = regions[place.region];
      record.regions.push_back({depths_m[place.region], region.force_n, region.torque_nm, region.area_m2, place.id,
                                region.friction_n, scene_.contact.friction && region.stuck_share == 0.0});
    }
    // The tool may dip in between the nodes.
    if (regions.empty() && record.depth_m > 0.0) record.regions.push_back({.depth_m = record.depth_m});
  }

  const Scene& scene_;
  ModelChoice choice_;
  const Options& options_;
  std::unique_ptr<const scene::Shape> body_;
  std::vector<double> times_s_;
  int levels_;
  std::vector<Mesh<dim>> meshes_;
  std::vector<SurfaceSampler<dim>> samplers_;
  std::optional<Estimate> estimate_;
};

/// Displacement unknowns of a level, without counting the few prescribed ones out.
std::string expected_unknowns(const Scene& scene, const ModelChoice& choice, int level) {
  const int nodes = choice.dim == 2 ? level_mesh<2>(scene, choice, level).node_count()
                                    : level_mesh<3>(scene, choice, level).node_count();
  return "at most " + std::to_string(choice.dim * nodes) + " displacement unknowns";
}

template <class Add>
void add_tool_line(const Scene& scene, const Add& add) {
  std::ostringstream how;
  how << std::setprecision(3);
  if (scene.tool.shape == scene::ToolShape::mesh) {
    how << "signed distance on a grid of " << 1e3 * grid_spacing_m(*scene.tool.mesh)
        << " mm with a tricubic spline; sharp edges are rounded over about as much";
  } else {
    how << "exact signed distance";
    if (scene.tool.shape == scene::ToolShape::box) {
      how << " of a box with edges rounded by " << 0.5e3 * box_edge_share * scene.tool.size_m.minCoeff()
          << " mm: sharp ones have unbounded pressure";
    }
  }
  add("tool", true, how.str());
}

}  // namespace

std::vector<scene::Fault> unsupported(const Scene& scene) { return unsupported_parts(scene); }

std::string content_key(const Scene& scene) { return Store::key(identity_text(scene)); }

scene::Plan plan(const Scene& scene) {
  const ModelChoice choice = choose_model(scene);
  const int mirrors = (choice.mirror_x ? 1 : 0) + (choice.mirror_y ? 1 : 0);
  scene::Plan plan;
  const auto add = [&](const char* part, bool modelled, const std::string& reason, const std::string& cost = {}) {
    plan.push_back({part, modelled, reason, cost});
  };
  if (choice.dim == 2) {
    add("axial symmetry", true, "body and tool are of revolution about one axis: one meridian plane is the whole body");
  } else if (mirrors > 0) {
    add(mirrors == 2 ? "quarter symmetry" : "half symmetry", true,
        mirrors == 2 ? "body, inclusions, tool and track share the planes x = 0 and y = 0"
                     : "body, inclusions, tool and track share one of the planes x = 0 and y = 0",
        mirrors == 2 ? "a quarter of the unknowns" : "half of the unknowns");
  } else {
    add("symmetry", false, "body, inclusions, tool and track share no symmetry plane", "the whole body is meshed");
  }
  const bool finite = scene.reference.kinematics == scene::Kinematics::finite;
  add("finite strain", finite,
      finite ? "neo-Hookean, deformed geometry in contact"
             : "reference.kinematics is \"small\": linear elasticity, gap along the rest normal");
  std::ostringstream nu;
  nu << "nu = " << scene.body.material.poissons_ratio << "; "
     << (scene.body.material.poissons_ratio == 0.5 ? "incompressible, the pressure keeps the volume"
                                                   : "the same mixed element serves every nu, so nothing locks");
  add("pressure unknowns", true, nu.str(), "eliminated cell by cell, none in the global matrix");
  if (scene.contact.friction) {
    add("friction", true,
        "|t| <= m N at every node, m of its region: stuck m F_n = K F_n^beta, sliding m = mu_D, but no more than stuck",
        "every load step is an increment of the path");
  } else {
    add("friction", false, "the scene has none");
  }
  add("several contact regions", !scene.tool.convex(),
      scene.tool.convex() ? "a convex tool touches a convex body once"
                          : "touching nodes nearer than fast.r_th_m, or of one cell face, are one region");
  add_tool_line(scene, add);
  const std::size_t inclusions = scene.body.inclusions.size();
  if (inclusions == 0) {
    add("inclusions", false, "the body is of one material");
  } else {
    add("inclusions", true,
        std::to_string(inclusions) + " of another material, each integration point has the one it lies in",
        "small cells at their surfaces");
  }
  add("uncertainty", scene.reference.levels >= 3,
      scene.reference.levels >= 3 ? "from " + std::to_string(scene.reference.levels) + " refinement levels"
                                  : "fewer than three levels: unknown, reported as infinite");
  for (int level = 0; level < scene.reference.levels; ++level) {
    std::ostringstream size;
    size << "cells of " << std::setprecision(3) << 1e3 * element_size_m(scene, choice, level)
         << " mm at the deepest contact's rim";
    add(("level " + std::to_string(level + 1)).c_str(), true, size.str(), expected_unknowns(scene, choice, level));
  }
  return plan;
}

Result solve(const Scene& scene, const Eigen::Matrix3Xd& rest_points_m, const Options& options) {
  if (std::vector<scene::Fault> faults = unsupported(scene); !faults.empty())
    throw scene::InputError(std::move(faults));
  const ModelChoice choice = choose_model(scene);
  if (choice.dim == 2) return Run<2>(scene, choice, rest_points_m, options).answer();
  return Run<3>(scene, choice, rest_points_m, options).answer();
}

}  // namespace touchstone::reference
