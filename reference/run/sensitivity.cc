#include "reference/run/sensitivity.h"

#include "reference/contact/contact_problem.h"
#include "reference/contact/prolongation.h"
#include "reference/mesh/sampling.h"
#include "reference/run/step_record.h"
#include "reference/run/uncertainty.h"
#include "reference/tool/distance_grid.h"
#include "scene/base/stopwatch.h"

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace touchstone::reference {
namespace {

/// One choice of the method that is changed.
struct Change {
  const char* part;
  const char* text;
  Carries carries = Carries::wholly;
  Numerics numerics{};
  MeshChange mesh{};
  int load_steps = 1;                                           // in place of one
  std::function<std::shared_ptr<const ToolDistance>()> tool{};  // takes seconds to make
  [[nodiscard]] bool other_mesh() const { return mesh.far_field != 1.0 || mesh.inclusions != 1.0; }
};

std::vector<Change> changes(const scene::Scene& scene) {
  std::vector<Change> list;
  // Friction's increments are of first order, and half as long they show too little: a ball pressed into a cylinder in
  // three steps is 0.23 % too weak, of which six show 0.06 and twelve 0.15 %.
  if (scene.contact.friction) {
    list.push_back(
        {.part = "load_step", .text = "a quarter as long", .carries = Carries::first_order, .load_steps = 4});
  } else {
    list.push_back({.part = "load_step", .text = "half as long", .load_steps = 2});
  }
  list.push_back({.part = "contact_parameter",
                  .text = "ten times as large",
                  .numerics = {.contact_parameter = 10.0, .numerical_bulk = 1.0}});
  list.push_back({.part = "numerical_bulk",
                  .text = "ten times as large",
                  .numerics = {.contact_parameter = 1.0, .numerical_bulk = 10.0}});
  if (scene.tool.shape == scene::ToolShape::mesh) {
    list.push_back({.part = "tool_grid", .text = "half as wide", .tool = [&scene] {
                      const scene::TriangleMesh mesh = scene::tool_mesh(scene.tool);
                      return std::make_shared<DistanceGrid>(mesh, 0.5 * grid_spacing_m(mesh));
                    }});
  }
  // An estimate has chosen the cells everywhere, and the levels' differences hold what they miss.
  if (scene.reference.adaptive_share) return list;
  // Every level has smaller cells at the inclusions, so the levels' differences hold this one.
  if (!scene.body.inclusions.empty()) {
    list.push_back({.part = "inclusion_cells",
                    .text = "half as large",
                    .carries = Carries::in_the_levels,
                    .mesh = {.far_field = 1.0, .inclusions = 0.5}});
  }
  list.push_back({.part = "far_field",
                  .text = "cells half as large",
                  .carries = Carries::far_field,
                  .mesh = {.far_field = 0.5, .inclusions = 1.0}});
  return list;
}

/// Its name in the store.
std::string name_of(const Change& change) { return std::string("sensitivity-") + change.part; }

template <int dim>
Discretisation<dim> changed_mesh(const scene::Scene& scene, const ModelChoice& choice,
                                 const Discretisation<dim>& coarsest, const Change& change) {
  return change.other_mesh() ? level_mesh<dim>(scene, choice, 0, change.mesh) : coarsest;
}

template <int dim>
class Repeat {
 public:
  Repeat(const SensitivityCase<dim>& given, const SensitivityWatch& watch)
      : given_(given), watch_(watch), body_(scene::body_shape(given.scene.body)) {}

  /// The instant's solution with one choice changed. @throws NotConverged
  std::pair<Solved<dim>, Step> solve(const Change& change, const Discretisation<dim>& mesh) const {
    const scene::Stopwatch time;
    const scene::Scene& scene = given_.scene;
    ContactProblem<dim> problem(mesh, scene.body.material, scene.reference.kinematics, given_.choice.mirror_x,
                                given_.choice.mirror_y, ranks::threads(), change.numerics);
    if (scene.contact.friction) problem.set_friction(*scene.contact.friction, scene.contact.r_th_m);
    const auto tool = change.tool ? change.tool() : given_.choice.tool;
    const auto tool_anywhere = [&](double time_s) { return RigidTool<dim>(tool, scene::pose_at(scene.track, time_s)); };
    LoadPath<dim> path(
        problem,
        [&](double time_s) -> std::optional<RigidTool<dim>> {
          if (scene::rest_depth_m(*body_, scene.tool, scene::pose_at(scene.track, time_s)) <= 0.0) return std::nullopt;
          return tool_anywhere(time_s);
        },
        tool_anywhere);
    std::pair<Solved<dim>, Step> result;
    // By name: clang 14 lets no lambda capture a structured binding.
    Solved<dim>& solved = result.first;
    Step& step = result.second;
    const std::size_t last = given_.times_s.size() - 1;
    const double lead_s = last > 0 ? given_.times_s[1] - given_.times_s[0] : 1.0;
    const auto follow = [&](Solved<dim> current, std::size_t first) {
      AdvanceReport report;
      std::optional<Solved<dim>> before;
      for (std::size_t instant = first; instant <= last; ++instant) {
        const double from_s = current.time_s, to_s = given_.times_s[instant];
        for (int k = 1; k <= change.load_steps; ++k) {
          const double share = static_cast<double>(k) / change.load_steps;
          // With friction the state found depends a little on where Newton starts. So it starts as for the level
          // itself; only shorter load steps start without the linear predictor, and their change includes its effect.
          const bool predict = before && change.load_steps == 1;
          report = path.advance(predict ? &*before : nullptr, current,
                                k == change.load_steps ? to_s : from_s + share * (to_s - from_s), solved,
                                [&](int iteration, double) { watch_(change.part, iteration); }, {});
          step.newton_iterations += report.newton_iterations;
          step.halvings += report.halvings;
          if (!report.converged) return report;
          before = std::exchange(current, solved);
        }
      }
      return report;
    };
    // Friction depends on the path, so all steps are solved. Without it the last step is enough, and on another mesh
    // the solution itself serves as the start, unless the other cells change it too much.
    const Solved<dim> rest{given_.times_s[0] - lead_s, problem.rest(), false};
    AdvanceReport report;
    report.converged = false;
    if (!scene.contact.friction) {
      Solved<dim> start = given_.before ? *given_.before : rest;
      if (change.other_mesh()) {
        start = {given_.at.time_s - lead_s, Prolongation<dim>(given_.mesh, mesh)(given_.at.state), true};
      }
      report = follow(std::move(start), last);
    }
    if (!report.converged) report = follow(rest, 0);
    if (!report.converged) {
      throw NotConverged(std::string("the sensitivity to the ") + change.part +
                         " did not converge: " + report.last.trouble);
    }
    step.seen = problem.observe(solved.state, scene.contact.r_th_m);
    step.unknowns = problem.unknowns();
    step.linear_solver = problem.linear_solver();
    step.wall_s = time.wall_s();
    step.cpu_s = time.cpu_s();
    return result;
  }

 private:
  const SensitivityCase<dim>& given_;
  const SensitivityWatch& watch_;
  std::unique_ptr<const scene::Shape> body_;
};

}  // namespace

double share_at(const Sensitivity& sensitivity, int level) {
  // Halving cells of second order leaves a third of what it takes away; quadratic ones do better.
  constexpr double not_seen = 4.0 / 3.0;
  switch (sensitivity.carries) {
    case Carries::wholly:
      return 1.0;
    case Carries::first_order:  // a quarter remains
      return 4.0 / 3.0;
    case Carries::far_field:
      return not_seen * far_share(level);
    case Carries::in_the_levels:
      return 0.0;
  }
  return 1.0;
}

template <int dim>
std::vector<SensitivityWork> missing_sensitivities(const scene::Scene& scene, const ModelChoice& choice,
                                                   const Discretisation<dim>& coarsest, int touching,
                                                   const Store* store) {
  std::vector<SensitivityWork> list;
  for (const Change& change : changes(scene)) {
    if (store && store->read(name_of(change))) continue;
    // With friction the whole track up to there is followed again, without it the last load step alone.
    const int load_steps = (scene.contact.friction ? touching : 1) * change.load_steps;
    list.push_back({change.part,
                    {.dim = dim,
                     .unknowns = unknowns_of(changed_mesh(scene, choice, coarsest, change)),
                     .load_steps = load_steps,
                     .friction = scene.contact.friction.has_value()}});
  }
  return list;
}

template <int dim>
std::optional<ChangedSolution<dim>> stored_sensitivity(const scene::Scene& scene, const ModelChoice& choice,
                                                       const Discretisation<dim>& coarsest, const Store& store,
                                                       const std::string& part) {
  for (const Change& change : changes(scene)) {
    if (change.part != part) continue;
    ChangedSolution<dim> result{changed_mesh(scene, choice, coarsest, change), {}};
    const auto record = store.read(name_of(change));
    auto found = record ? from_record<dim>(*record, result.mesh) : std::nullopt;
    if (!found) return std::nullopt;
    result.solved = std::move(found->first);
    return result;
  }
  return std::nullopt;
}

template <int dim>
std::vector<Sensitivity> sensitivities(const SensitivityCase<dim>& given, const Store& store,
                                       const SensitivityWatch& watch) {
  const auto sampled = [&](const Discretisation<dim>& mesh, const Solved<dim>& solved) {
    return SurfaceSampler<dim>(mesh, given.rest_points_m, given.choice.mirror_x, given.choice.mirror_y)
        .at_points(solved.state.u_m);
  };
  const Eigen::Matrix3Xd u_m = sampled(given.mesh, given.at);
  const Eigen::VectorXd area_m2 = areas_or_ones(given.rest_area_m2, u_m.cols());
  const double scale = u_m.colwise().squaredNorm().transpose().dot(area_m2);
  const Repeat<dim> repeat(given, watch);
  std::vector<Sensitivity> list;
  for (const Change& change : changes(given.scene)) {
    const Discretisation<dim> mesh = changed_mesh(given.scene, given.choice, given.mesh, change);
    std::optional<std::pair<Solved<dim>, Step>> found;
    const std::string name = name_of(change);
    if (const auto record = store.read(name)) found = from_record<dim>(*record, mesh);
    if (!found) {
      found = repeat.solve(change, mesh);
      store.write(name, to_record(found->first, found->second));
    }
    Sensitivity& one = list.emplace_back();
    one.part = change.part;
    one.change = change.text;
    one.carries = change.carries;
    one.force_rel = (found->second.seen.force_n - given.force_n).norm() / given.force_n.norm();
    one.displacement_change_m = (sampled(mesh, found->first) - u_m).colwise().norm().transpose();
    const double changed = one.displacement_change_m.cwiseAbs2().dot(area_m2);
    one.shape_rel = scale > 0.0 ? std::sqrt(changed / scale) : 0.0;
  }
  return list;
}

template std::vector<SensitivityWork> missing_sensitivities(const scene::Scene&, const ModelChoice&,
                                                            const Discretisation<2>&, int, const Store*);
template std::vector<SensitivityWork> missing_sensitivities(const scene::Scene&, const ModelChoice&,
                                                            const Discretisation<3>&, int, const Store*);
template std::vector<Sensitivity> sensitivities(const SensitivityCase<2>&, const Store&, const SensitivityWatch&);
template std::vector<Sensitivity> sensitivities(const SensitivityCase<3>&, const Store&, const SensitivityWatch&);

}  // namespace touchstone::reference
