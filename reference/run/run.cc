#include "reference/run/run.h"

#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/contact/stuck_contact.h"
#include "reference/mesh/prolongation.h"
#include "reference/mesh/sampling.h"
#include "reference/run/identity.h"
#include "reference/run/records.h"
#include "reference/run/sensitivity.h"
#include "reference/run/step_record.h"
#include "reference/run/store.h"
#include "reference/run/uncertainty.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <sstream>

namespace touchstone::reference {
namespace {

using scene::Scene;
using Clock = std::chrono::steady_clock;

constexpr int fewest_levels = 3, most_levels = 9;
constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double cpu_seconds_since(std::clock_t begin) { return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; }

/// How the time of a level grows with its unknowns: between assembly (1) and the factorisation in space (2).
double work_of(double unknowns) { return std::pow(unknowns, 1.7); }

double physical_memory_bytes() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// One scene being answered. Levels and instants count from zero here, from one in everything shown.
template <int dim>
class Run {
 public:
  Run(const Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m, const Options& options)
      : scene_(scene),
        choice_(choice),
        rest_points_m_(rest_points_m),
        options_(options),
        body_(scene::body_shape(scene.body)),
        times_s_(scene::instants_s(scene)) {
    result_.model = choice_.name(scene_.reference.kinematics);
  }

  Result answer() {
    const std::string identity = identity_text(scene_);
    Store store(options_.store, identity, [&] {
      show({.instants = count(), .note = "another run is solving this scene; waiting for it"});
      check_stop();
    });
    result_.key = Store::key(identity);
    result_.from_store = true;
    result_.refinement.error_asked = scene_.reference.levels ? 0.0 : scene_.reference.error;
    while (add_level(store)) {
    }
    if (result_.from_store) {
      show({.level = solved_levels(), .instant = count(), .instants = count(), .note = "from the store"});
    }
    return std::move(result_);
  }

 private:
  /// What the store keeps of a level, with the displacement at the rest points.
  struct Level {
    std::vector<Step> steps;
    std::vector<Eigen::Matrix3Xd> shapes;
  };

  [[nodiscard]] int count() const { return static_cast<int>(times_s_.size()); }
  [[nodiscard]] int solved_levels() const { return static_cast<int>(result_.levels.size()); }

  [[nodiscard]] double depth_m(double time_s) const {
    return scene::rest_depth_m(*body_, scene_.tool, scene::pose_at(scene_.track, time_s));
  }

  void check_stop() const {
    if (options_.stop && options_.stop->load()) {
      throw Interrupted("interrupted; every finished load step is in the store and the next run goes on from there");
    }
  }

  void show(Progress progress) const {
    progress.levels = scene_.reference.levels.value_or(0);
    if (options_.progress) options_.progress(progress);
  }

  [[nodiscard]] bool out_of_time() const { return seconds_since(begin_) > options_.seconds_limit; }

  /// Solves one level more and takes it into the result. @returns whether another one is wanted
  bool add_level(const Store& store) {
    const int level = solved_levels();
    auto mesh = std::make_unique<Mesh<dim>>(level_mesh<dim>(scene_, choice_, level));
    if (std::string why = limit_before(level, *mesh, store); !why.empty()) return stop_at(std::move(why));
    Level answer;
    try {
      if (!solve_level(level, *mesh, store, answer)) return stop_at(not_started(level) + "the time was up");
    } catch (const NotConverged& failure) {
      if (scene_.reference.levels || level < fewest_levels) throw;
      return stop_at(not_started(level) + "it did not converge: " + failure.what());
    } catch (const std::bad_alloc&) {
      if (scene_.reference.levels || level < fewest_levels) throw;
      return stop_at(not_started(level) + "the memory did not suffice");
    }
    take(level, answer);
    coarser_ = std::move(mesh);
    if (level == 0) coarsest_ = *coarser_;
    if (solved_levels() >= fewest_levels) {
      if (!sensitivities_known_) measure_sensitivities(store);
      estimate_uncertainty();
    } else {
      unknown_uncertainty();
    }
    if (scene_.reference.levels) return solved_levels() < *scene_.reference.levels;
    result_.refinement.reached = small_enough(result_.force_uncertainty_rel) &&
                                 small_enough(result_.shape_uncertainty_rel) && solved_levels() >= fewest_levels;
    std::ostringstream text;
    if (result_.refinement.reached) {
      text << "force and shape are known to " << scene_.reference.error << " after " << solved_levels() << " levels";
      return stop_at(text.str());
    }
    if (const Sensitivity* one = too_sensitive()) {
      text << not_started(solved_levels()) << "finer meshes do not help, since " << one->part << ' ' << one->change
           << " changes the force by " << one->force_rel << " and the shape by " << one->shape_rel;
      if (one->carries == Carries::first_order) text << "; more instants would";
      return stop_at(text.str());
    }
    return true;
  }

  /// Nothing to be uncertain about is small enough, too.
  [[nodiscard]] bool small_enough(const std::optional<double>& uncertainty_rel) const {
    return uncertainty_rel.value_or(0.0) <= scene_.reference.error;
  }

  /// The largest of the sensitivities that refinement does not touch, when these alone exceed the error asked for.
  [[nodiscard]] const Sensitivity* too_sensitive() const {
    const Sensitivity* largest = nullptr;
    double force_rel = 0.0, shape_rel = 0.0;
    const auto size = [](const Sensitivity& one) { return std::max(one.force_rel, one.shape_rel); };
    for (const Sensitivity& one : result_.sensitivities) {
      if (one.carries != Carries::wholly && one.carries != Carries::first_order) continue;
      force_rel += share_at(one, most_levels) * one.force_rel;
      shape_rel += share_at(one, most_levels) * one.shape_rel;
      if (!largest || size(one) > size(*largest)) largest = &one;
    }
    return std::max(force_rel, shape_rel) > scene_.reference.error ? largest : nullptr;
  }

  bool stop_at(std::string why) {
    result_.refinement.why_ended = std::move(why);
    return false;
  }

  [[nodiscard]] static std::string not_started(int level) {
    return "there is no level " + std::to_string(level + 1) + ": ";
  }

  /// Why not to begin with a level, in words; empty when nothing speaks against it. The first is always solved.
  [[nodiscard]] std::string limit_before(int level, const Mesh<dim>& mesh, const Store& store) const {
    if (level == 0 || scene_.reference.levels) return {};
    if (level >= most_levels) return not_started(level) + "no scene is refined further";
    int missing = 0;
    for (int instant = 0; instant < count(); ++instant) {
      if (!std::filesystem::exists(store.step_file(level, instant))) ++missing;
    }
    if (missing == 0) return {};
    std::ostringstream text;
    text.precision(3);
    text << not_started(level);
    const double unknowns = dim * static_cast<double>(mesh.node_count());
    const double limit_bytes = options_.memory_limit_bytes.value_or(0.8 * physical_memory_bytes());
    if (const double needed_bytes = expected_memory_bytes(dim, unknowns); needed_bytes > limit_bytes) {
      text << unknowns << " unknowns would take about " << needed_bytes / gibibyte << " GiB of memory, more than "
           << limit_bytes / gibibyte;
      return text.str();
    }
    const LevelRecord& last = result_.levels.back();
    const double needed_s = last.wall_s * work_of(unknowns / last.unknowns) * missing / count();
    if (const double left_s = options_.seconds_limit - seconds_since(begin_); needed_s > left_s) {
      text << "it would take about " << needed_s / 60.0 << " min, more than the " << std::max(0.0, left_s) / 60.0
           << " min left";
      return text.str();
    }
    return {};
  }

  void take(int level, Level& answer) {
    LevelRecord record;
    record.element_size_m = element_size_m(scene_, choice_, level);
    for (const Step& step : answer.steps) {
      record.unknowns = std::max(record.unknowns, step.unknowns);
      record.newton_iterations += step.newton_iterations;
      record.steps_cut += step.halvings;
      record.wall_s += step.wall_s;
      record.cpu_s += step.cpu_s;
      record.force_n.push_back(step.seen.force_n.norm());
      if (!step.linear_solver.empty()) result_.linear_solver = step.linear_solver;
    }
    result_.levels.push_back(std::move(record));
    fill_records(scene_, times_s_, answer.steps, answer.shapes, result_);
    shapes_.push_back(std::move(answer.shapes));
  }

  void unknown_uncertainty() {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    result_.force_uncertainty_n.assign(times_s_.size(), unknown);
    result_.displacement_uncertainty_m.assign(times_s_.size(),
                                              Eigen::VectorXd::Constant(rest_points_m_.cols(), unknown));
    result_.force_uncertainty_rel = force_uncertainty_rel(result_.instants, result_.force_uncertainty_n);
    result_.shape_uncertainty_rel =
        shape_uncertainty_rel(result_.instants, result_.displacement_uncertainty_m, options_.rest_area_m2);
  }

  void estimate_uncertainty() {
    std::vector<double> finer;
    std::vector<std::vector<double>> forces_n;
    for (int level = 0; level < solved_levels(); ++level) {
      finer.push_back(refinement(level));
      forces_n.push_back(result_.levels[level].force_n);
    }
    result_.force_uncertainty_n = force_band(forces_n, finer);
    result_.displacement_uncertainty_m = displacement_band(shapes_, finer);
    add_sensitivities(solved_levels() - 1);
    result_.force_uncertainty_rel = force_uncertainty_rel(result_.instants, result_.force_uncertainty_n);
    result_.shape_uncertainty_rel =
        shape_uncertainty_rel(result_.instants, result_.displacement_uncertainty_m, options_.rest_area_m2);
  }

  /// Reads what the store has and solves the rest, in track order. @returns false when the time was up
  bool solve_level(int level, const Mesh<dim>& mesh, const Store& store, Level& answer) {
    const SurfaceSampler<dim> sampler(mesh, rest_points_m_, choice_.mirror_x, choice_.mirror_y);
    std::optional<ContactProblem<dim>> problem;  // only when something has to be solved
    std::optional<Prolongation<dim>> prolongation;
    std::optional<Solved<dim>> before, current;
    double solved_s = 0.0;
    int solved = 0;
    for (int instant = 0; instant < count(); ++instant) {
      const double time_s = times_s_[instant];
      check_stop();
      std::optional<std::pair<Solved<dim>, Step>> found;
      if (std::optional<Record> record = store.read(level, instant)) found = from_record<dim>(std::move(*record), mesh);
      if (!found) {
        if (level > 0 && !scene_.reference.levels && out_of_time()) return false;
        std::string note;
        if (instant > 0 && !problem && result_.from_store) {
          note = "resumed on mesh " + std::to_string(level + 1) + " at instant " + std::to_string(instant + 1);
        }
        result_.from_store = false;
        if (!problem) {
          problem.emplace(mesh, scene_.body.material, scene_.reference.kinematics, choice_.mirror_x, choice_.mirror_y);
          if (scene_.contact.friction) problem->set_friction(*scene_.contact.friction, scene_.fast.r_th_m);
          if (level > 0 && !scene_.contact.friction) prolongation.emplace(*coarser_, mesh);
        }
        if (!note.empty()) show({.level = level + 1, .instant = instant + 1, .instants = count(), .note = note});
        std::optional<State<dim>> start;
        if (prolongation) start = start_state(*prolongation, store, level, instant);
        const double left_s = solved > 0 ? solved_s / solved * (count() - instant) : -1.0;
        found = solve_instant(*problem, level, instant, std::move(start), before, current, left_s);
        store.write(level, instant, to_record(found->first, found->second));
        solved_s += found->second.wall_s;
        if (found->first.touching) ++solved;
        show({.level = level + 1,
              .instant = instant + 1,
              .instants = count(),
              .depth_m = depth_m(time_s),
              .newton = found->second.newton_iterations,
              .unknowns = found->second.unknowns,
              .seconds_left = solved > 0 ? solved_s / solved * (count() - instant - 1) : -1.0,
              .step_finished = true});
      }
      answer.shapes.push_back(sampler.displacement_m(found->first.state.u_m));
      answer.steps.push_back(std::move(found->second));
      before = std::move(current);
      current = std::move(found->first);
    }
    return true;
  }

  /// The coarser level's solution on this level's mesh; nothing when the tool did not touch there.
  [[nodiscard]] std::optional<State<dim>> start_state(const Prolongation<dim>& prolongation, const Store& store,
                                                      int level, int instant) const {
    std::optional<Record> record = store.read(level - 1, instant);
    const auto coarse = record ? from_record<dim>(std::move(*record), *coarser_) : std::nullopt;
    if (!coarse || !coarse->first.touching) return std::nullopt;
    return prolongation(coarse->first.state);
  }

  [[nodiscard]] RigidTool<dim> tool_anywhere(double time_s) const {
    return RigidTool<dim>(choice_.tool, scene::pose_at(scene_.track, time_s));
  }

  [[nodiscard]] std::optional<RigidTool<dim>> tool_at(double time_s) const {
    if (depth_m(time_s) <= 0.0) return std::nullopt;
    return tool_anywhere(time_s);
  }

  /// @param start  where Newton begins, or nothing to follow the track
  /// @param left_s  estimate for this instant and the rest of the level, or negative
  std::pair<Solved<dim>, Step> solve_instant(ContactProblem<dim>& problem, int level, int instant,
                                             std::optional<State<dim>> start, const std::optional<Solved<dim>>& before,
                                             const std::optional<Solved<dim>>& current, double left_s) {
    const double time_s = times_s_[instant];
    const Clock::time_point begin = Clock::now();
    const std::clock_t cpu_begin = std::clock();
    std::pair<Solved<dim>, Step> result{{time_s, problem.rest(), false}, {}};
    auto& [solved, step] = result;
    step.unknowns = problem.unknowns();
    Progress progress{.level = level + 1,
                      .instant = instant + 1,
                      .instants = count(),
                      .depth_m = depth_m(time_s),
                      .unknowns = problem.unknowns()};
    const auto watch = [&](int iteration, double residual_rel) {
      progress.newton = iteration;
      progress.residual_rel = residual_rel;
      progress.seconds_left = left_s < 0.0 ? -1.0 : std::max(0.0, left_s - seconds_since(begin));
      show(progress);
      check_stop();
    };
    const std::optional<RigidTool<dim>> tool = tool_at(time_s);
    bool converged = false;
    if (start && tool) {
      problem.set_tool(*tool);
      solved.state = std::move(*start);
      const NewtonReport report = problem.solve(solved.state, watch);
      step.newton_iterations += report.iterations;
      step.indefinite += report.indefinite;
      converged = solved.touching = report.converged;
    }
    if (!converged) {
      LoadPath<dim> path(
          problem, [&](double t) { return tool_at(t); }, [&](double t) { return tool_anywhere(t); });
      // A track that starts in contact is entered from rest, a moment before its first instant.
      const double lead_s = times_s_.size() > 1 ? times_s_[1] - times_s_[0] : 1.0;
      const Solved<dim> from = current ? *current : Solved<dim>{time_s - lead_s, problem.rest(), false};
      const AdvanceReport report =
          path.advance(before ? &*before : nullptr, from, time_s, solved, watch, [&](double failed_s) {
            std::ostringstream note;
            note << "load step halved at t = " << failed_s << " s";
            Progress halved = progress;
            halved.note = note.str();
            show(halved);
          });
      step.newton_iterations += report.newton_iterations;
      step.halvings = report.halvings;
      step.indefinite += report.indefinite;
      if (!report.converged) {
        const std::string where = stuck_contact_text(problem, path.stuck()->state, scene_.fast.r_th_m);
        throw NotConverged(not_converged_text(level, instant, report, where));
      }
    }
    if (solved.touching) {
      step.seen = problem.observe(solved.state, scene_.fast.r_th_m);
      step.linear_solver = problem.linear_solver();
    }
    step.wall_s = seconds_since(begin);
    step.cpu_s = cpu_seconds_since(cpu_begin);
    return result;
  }

  /// On the coarsest level at the deepest instant, from the store where they are known.
  void measure_sensitivities(const Store& store) {
    sensitivities_known_ = true;
    const auto deepest = std::max_element(result_.instants.begin(), result_.instants.end(),
                                          [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
    const int instant = static_cast<int>(deepest - result_.instants.begin());
    if (result_.levels[0].force_n[instant] == 0.0) return;
    const auto stored = [&](int which) {
      std::optional<Record> record = which < 0 ? std::nullopt : store.read(0, which);
      return record ? from_record<dim>(std::move(*record), coarsest_) : std::nullopt;
    };
    const auto at = stored(instant), before = stored(instant - 1);
    if (!at) return;
    const std::vector<double> times_s(times_s_.begin(), times_s_.begin() + instant + 1);
    result_.sensitivities =
        sensitivities<dim>({scene_, choice_, coarsest_, rest_points_m_, options_.rest_area_m2, times_s, at->first,
                            at->second.seen.force_n, before ? &before->first : nullptr},
                           store, [&](const std::string& part, int iteration) {
                             result_.from_store = false;
                             check_stop();
                             if (iteration > 0) return;
                             show({.instants = count(), .note = "sensitivity to the " + part});
                           });
  }

  /// What the differences of the levels do not show.
  void add_sensitivities(int finest) {
    double deepest_m = 0.0;
    for (const auto& instant : result_.instants) deepest_m = std::max(deepest_m, instant.depth_m);
    for (const Sensitivity& one : result_.sensitivities) {
      const double share = share_at(one, finest);
      if (share == 0.0) continue;
      for (std::size_t i = 0; i < result_.instants.size(); ++i) {
        result_.force_uncertainty_n[i] += share * one.force_rel * result_.instants[i].force_n().norm();
        result_.displacement_uncertainty_m[i] +=
            share * result_.instants[i].depth_m / deepest_m * one.displacement_change_m;
      }
    }
  }

  [[nodiscard]] std::string not_converged_text(int level, int instant, const AdvanceReport& report,
                                               const std::string& where) const {
    std::ostringstream text;
    text << "instant " << instant + 1 << " of " << count() << " (t = " << times_s_[instant] << " s, depth "
         << depth_m(times_s_[instant]) << " m) did not converge on level " << level + 1 << ": " << report.last.trouble
         << ", residual " << report.last.residual_rel
         << " of the acting forces (asked: " << ContactProblem<dim>::force_tolerance
         << "), stuck at t = " << report.stuck_time_s << " s after " << report.halvings << " halvings, " << where
         << ". Finished steps are kept. Try a smaller reference.element_size_m (now "
         << element_size_m(scene_, choice_, 0) << " m on the coarsest level), more instants, or less depth.";
    return text.str();
  }

  const Scene& scene_;
  const ModelChoice& choice_;
  const Eigen::Matrix3Xd& rest_points_m_;
  const Options& options_;
  std::unique_ptr<const scene::Shape> body_;
  std::vector<double> times_s_;
  Clock::time_point begin_ = Clock::now();
  Result result_;
  std::unique_ptr<Mesh<dim>> coarser_;  // of the level solved last
  Mesh<dim> coarsest_;
  std::vector<std::vector<Eigen::Matrix3Xd>> shapes_;  // per level and instant, 3 x rest points
  bool sensitivities_known_ = false;
};

}  // namespace

double expected_memory_bytes(int dim, double unknowns) {
  constexpr double measured_bytes = 1.6e9, measured_unknowns = 93e3;
  return dim == 3 ? measured_bytes * std::pow(unknowns / measured_unknowns, 1.4) : 5e3 * unknowns;
}

Result run(const Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m,
           const Options& options) {
  if (choice.dim == 2) return Run<2>(scene, choice, rest_points_m, options).answer();
  return Run<3>(scene, choice, rest_points_m, options).answer();
}

}  // namespace touchstone::reference
