#include "reference/run/run.h"

#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/contact/prolongation.h"
#include "reference/contact/stuck_contact.h"
#include "reference/mesh/boundary_surface.h"
#include "reference/mesh/mesh_limit.h"
#include "reference/mesh/sampling.h"
#include "reference/run/adaptive.h"
#include "reference/run/cost.h"
#include "reference/run/identity.h"
#include "reference/run/records.h"
#include "reference/run/sensitivity.h"
#include "reference/run/step_record.h"
#include "reference/run/store.h"
#include "reference/run/uncertainty.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <optional>

namespace touchstone::reference {
namespace {

using scene::Scene;

/// How well the contact's edge is placed between two nodes, over their distance: up to 0.23 was measured against Hertz.
/// The meshes' differences can miss it, since the edge moves by whole nodes.
constexpr double edge_share_of_spacing = 0.25;

constexpr int fewest_levels = 3, most_levels = 9;

double physical_memory_bytes() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// Thrown between two Newton iterations when Options::seconds_limit is over.
struct TimeIsUp {};

std::string meshes_text(int count) { return std::to_string(count) + (count == 1 ? " mesh" : " meshes"); }

/// Largest distance of neighbouring nodes on the free faces at rest that the contact's edge crosses [m].
template <int dim>
double edge_spacing_m(const Discretisation<dim>& mesh, const std::vector<char>& touching) {
  double largest_m = 0.0;
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free) continue;
    const auto touches = [&](int node) { return touching[node] != 0; };
    const auto apart = [&](int node) { return touching[node] == 0 && !mesh.hangs(node); };
    if (std::ranges::none_of(face.nodes, touches) || std::ranges::none_of(face.nodes, apart)) continue;
    const double diagonal_m = (mesh.points_m.col(face.nodes.back()) - mesh.points_m.col(face.nodes.front())).norm();
    largest_m = std::max(largest_m, 0.5 * diagonal_m / std::sqrt(dim - 1.0));
  }
  return largest_m;
}

/// One scene being answered. Levels and instants count from zero here, from one in everything shown.
template <int dim>
class Run {
 public:
  Run(const Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m, const Options& options,
      const scene::Stopwatch& begin)
      : scene_(scene),
        choice_(choice),
        rest_points_m_(rest_points_m),
        options_(options),
        body_(scene::body_shape(scene.body)),
        times_s_(scene::instants_s(scene)),
        begin_(begin) {
    result_.model = choice_.name(scene_.reference.kinematics);
    for (const double time_s : times_s_) depths_m_.push_back(depth_m(time_s));
  }

  Result answer() {
    const std::string identity = identity_text(scene_);
    Store store(options_.store, identity, [&] {
      show({.instants = count(), .event = true, .note = "another run is solving this scene; waiting for it"});
      check_stop();
      if (out_of_time()) {
        throw LimitReached("no answer yet: the time was up while waiting for another run that is solving this scene");
      }
    });
    result_.key = Store::key(identity);
    result_.from_store = true;
    result_.refinement.error_asked = scene_.reference.levels ? 0.0 : scene_.reference.error;
    while (add_level(store)) {
    }
    if (result_.from_store) {
      show({.instants = count(), .event = true, .note = "from the store"});
    }
    return std::move(result_);
  }

 private:
  using Nodal = typename Discretisation<dim>::Nodal;

  /// What the store keeps of a level, with displacement and traction at the rest points.
  struct Level {
    std::vector<Step> steps;
    std::vector<Eigen::Matrix3Xd> shapes;
    std::vector<Eigen::Matrix3Xd> tractions_pa;
    std::vector<double> pressure_peaks_pa;
    std::vector<Eigen::Vector2d> half_axes_m;
    std::vector<double> edge_spacings_m;
    BoundarySurface deepest_surface;
  };

  [[nodiscard]] int count() const { return static_cast<int>(times_s_.size()); }
  [[nodiscard]] int solved_levels() const { return static_cast<int>(result_.levels.size()); }

  [[nodiscard]] double depth_m(double time_s) const {
    return scene::rest_depth_m(*body_, scene_.tool, scene::pose_at(scene_.track, time_s));
  }

  /// The first of several.
  [[nodiscard]] int deepest_instant() const {
    const auto less_deep = [&](double a_s, double b_s) { return depth_m(a_s) < depth_m(b_s); };
    return static_cast<int>(std::max_element(times_s_.begin(), times_s_.end(), less_deep) - times_s_.begin());
  }

  void check_stop() const {
    if (options_.stop && options_.stop->load()) {
      throw Interrupted("interrupted; every finished load step is in the store and the next run goes on from there");
    }
  }

  void show(Progress progress) const {
    progress.levels = std::max(known_levels(), progress.level);
    progress.at_least = !scene_.reference.levels;
    if (options_.progress) options_.progress(progress);
  }

  [[nodiscard]] double seconds_to_go() const { return options_.seconds_limit - begin_.wall_s(); }
  [[nodiscard]] bool out_of_time() const { return seconds_to_go() < 0.0; }
  void check_time() const {
    if (out_of_time()) throw TimeIsUp();
  }

  /// How many levels there will be, as far as that is known.
  [[nodiscard]] int known_levels() const {
    return std::max(scene_.reference.levels.value_or(fewest_levels), solved_levels());
  }

  [[nodiscard]] bool touches(int instant) const { return depths_m_[instant] > 0.0; }
  [[nodiscard]] int deepest() const {
    return static_cast<int>(std::max_element(depths_m_.begin(), depths_m_.end()) - depths_m_.begin());
  }

  /// Instants in contact that the store has not of a level.
  [[nodiscard]] int missing_steps(const Store& store, int level) const {
    int missing = 0;
    for (int instant = 0; instant < count(); ++instant) {
      if (touches(instant) && !std::filesystem::exists(store.step_file(level, instant))) ++missing;
    }
    return missing;
  }

  [[nodiscard]] Cost cost(double unknowns, int load_steps) const {
    return expected_cost(
        {.dim = dim, .unknowns = unknowns, .load_steps = load_steps, .friction = scene_.contact.friction.has_value()},
        ranks::threads());
  }

  /// What the sensitivities take that the store has not.
  [[nodiscard]] std::vector<SensitivityWork> missing_sensitivities(const Discretisation<dim>& coarsest,
                                                                   const Store& store) const {
    const auto until = depths_m_.begin() + deepest() + 1;
    const auto touching = std::count_if(depths_m_.begin(), until, [](double depth_m) { return depth_m > 0.0; });
    return reference::missing_sensitivities<dim>(scene_, choice_, coarsest, static_cast<int>(touching), &store);
  }

  /// Expected time of the known levels after this one and of the sensitivities, before the run's own pace [s].
  [[nodiscard]] double expected_after_s(int level, const Discretisation<dim>& mesh, const Store& store) const {
    double seconds = 0.0, adaptive_unknowns = unknowns_of(mesh);
    for (int next = level + 1; next < known_levels(); ++next) {
      const int missing = missing_steps(store, next);
      adaptive_unknowns *= adaptive_growth(scene_, dim);
      if (missing == 0) continue;
      try {
        const double unknowns =
            scene_.reference.adaptive_share ? adaptive_unknowns : unknowns_of(level_mesh<dim>(scene_, choice_, next));
        seconds += cost(unknowns, missing).seconds;
      } catch (const MeshTooLarge&) {
        return std::numeric_limits<double>::infinity();
      }
    }
    if (known_levels() >= fewest_levels && !sensitivities_known_) {
      for (const SensitivityWork& one : missing_sensitivities(level == 0 ? mesh : coarsest_, store)) {
        seconds += expected_cost(one.work, ranks::threads()).seconds;
      }
    }
    return seconds;
  }

  /// What is to be done after a load step has begun.
  struct Ahead {
    double step_s = 0.0;   // expected for one load step of the level
    int steps_after = 0;   // load steps of the level after this one
    double later_s = 0.0;  // expected after the level
    [[nodiscard]] double after_s() const { return steps_after * step_s + later_s; }
  };

  /// @param spent_s  on the load step so far; one that takes longer than expected still takes a tenth
  [[nodiscard]] double seconds_left(const Ahead& ahead, double spent_s) const {
    const double step_s = pace_.factor() * ahead.step_s;
    return std::max(0.1 * step_s, step_s - spent_s) + pace_.factor() * ahead.after_s();
  }

  /// Solves one level more and takes it into the result. @returns whether another one is wanted
  bool add_level(const Store& store) {
    const int level = solved_levels();
    if (!scene_.reference.levels && level >= most_levels) {
      return stop_at(EndedBy::done, not_started(level) + "no scene is refined further");
    }
    std::unique_ptr<Discretisation<dim>> mesh;
    Level answer;
    try {
      mesh = std::make_unique<Discretisation<dim>>(sequence_mesh<dim>(scene_, choice_, level, coarser_.get(), store));
      if (const std::optional<Limit> limit = limit_before(level, *mesh, store)) return end_before(level, *limit);
      solve_level(level, *mesh, store, answer);
    } catch (const TimeIsUp&) {
      return end_before(level,
                        {EndedBy::time, time_up_text(level, *mesh, store, static_cast<int>(answer.steps.size()))});
    } catch (const NotConverged& failure) {
      if (scene_.reference.levels || level < fewest_levels) throw;
      return stop_at(EndedBy::convergence, not_started(level) + "it did not converge: " + failure.what());
    } catch (const MeshTooLarge& failure) {
      return end_before(level, {EndedBy::memory, failure.what()});
    } catch (const std::bad_alloc&) {
      return end_before(level, {EndedBy::memory, "the memory did not suffice"});
    }
    take(level, *mesh, answer);
    coarser_ = std::move(mesh);
    if (level == 0) coarsest_ = *coarser_;
    const bool enough = solved_levels() >= fewest_levels;
    if (enough && !sensitivities_known_ && why_unknown_.empty()) {
      if (const std::optional<Limit> limit = measure_sensitivities(store)) {
        why_unknown_ = "the uncertainty is unknown after " + meshes_text(solved_levels()) + ": " + limit->why;
        // The meshes that were asked for are an answer without it, too.
        if (limit->by != EndedBy::sensitivity || !scene_.reference.levels) {
          unknown_uncertainty();
          return stop_at(limit->by, why_unknown_);
        }
      }
    }
    if (enough && why_unknown_.empty()) {
      estimate_uncertainty();
    } else {
      unknown_uncertainty();
    }
    if (scene_.reference.levels) {
      if (solved_levels() < *scene_.reference.levels) return true;
      const std::string asked = meshes_text(solved_levels()) + (solved_levels() == 1 ? " was" : " were") + " asked for";
      if (!enough) return stop_at(EndedBy::done, asked + needs_more());
      return why_unknown_.empty() ? stop_at(EndedBy::done, asked) : stop_at(EndedBy::sensitivity, why_unknown_);
    }
    result_.refinement.reached = small_enough(result_.force_uncertainty_rel) &&
                                 small_enough(result_.shape_uncertainty_rel) && solved_levels() >= fewest_levels;
    if (result_.refinement.reached) {
      return stop_at(EndedBy::done, fmt::format("force and shape are known to {:g} % after {}",
                                                100.0 * scene_.reference.error, meshes_text(solved_levels())));
    }
    if (const Sensitivity* one = too_sensitive()) {
      return stop_at(
          EndedBy::sensitivity,
          fmt::format(
              "{}finer meshes do not help, since {} {} changes the force by {:.3g} % and the shape by {:.3g} %{}",
              not_started(solved_levels()), one->part, one->change, 100.0 * one->force_rel, 100.0 * one->shape_rel,
              one->carries == Carries::first_order ? "; more instants would" : ""));
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

  bool stop_at(EndedBy by, std::string why) {
    result_.refinement.ended_by = by;
    result_.refinement.why_ended = std::move(why);
    return false;
  }

  [[nodiscard]] static std::string not_started(int level) {
    return "there is no mesh " + std::to_string(level + 1) + ": ";
  }

  [[nodiscard]] static std::string needs_more() { return "; an uncertainty needs " + std::to_string(fewest_levels); }

  /// A limit that forbids work, and the words for it.
  struct Limit {
    EndedBy by;
    std::string why;
  };

  /// Ends without a level for a limit's sake. @throws LimitReached when there is no coarser one, either
  bool end_before(int level, const Limit& limit) {
    if (level == 0) {
      throw LimitReached("no answer, since mesh 1 is not finished: " + limit.why +
                         ". Allow more, or make the cells larger with reference.element_size_m (now " +
                         fmt::format("{:.3g} m).", element_size_m(scene_, choice_, 0)));
    }
    return stop_at(limit.by, not_started(level) + limit.why + (level < fewest_levels ? needs_more() : ""));
  }

  [[nodiscard]] double memory_limit_bytes() const {
    return options_.memory_limit_bytes.value_or(0.8 * physical_memory_bytes());
  }

  /// ", and all that is left of 3 meshes about 2.1 h", or nothing when that is no more than has been said.
  [[nodiscard]] std::string all_meshes_text(int level, double mesh_s, double later_s) const {
    if (level + 1 >= known_levels()) return "";
    const double all_s = mesh_s + later_s;
    return ", and all that is left of " + meshes_text(known_levels()) +
           (std::isfinite(all_s) ? " about " + duration_text(all_s) : " more than can be done");
  }

  /// What forbids to begin with a level, if anything does.
  [[nodiscard]] std::optional<Limit> limit_before(int level, const Discretisation<dim>& mesh,
                                                  const Store& store) const {
    const int missing = missing_steps(store, level);
    if (missing == 0) return std::nullopt;
    const Cost needed = cost(unknowns_of(mesh), missing);
    const std::string its = fmt::format("its {} unknowns would take about ", std::lround(unknowns_of(mesh)));
    if (needed.memory_bytes > memory_limit_bytes()) {
      return Limit{EndedBy::memory, fmt::format("{}{} of memory, more than {}", its, memory_text(needed.memory_bytes),
                                                memory_text(memory_limit_bytes()))};
    }
    const double needed_s = pace_.factor() * needed.seconds;
    if (needed_s > seconds_to_go()) {
      return Limit{
          EndedBy::time,
          fmt::format("{}{} for {} load step{}, more than the {} left{}", its, duration_text(needed_s), missing,
                      missing == 1 ? "" : "s", duration_text(std::max(0.0, seconds_to_go())),
                      all_meshes_text(level, needed_s, pace_.factor() * expected_after_s(level, mesh, store)))};
    }
    return std::nullopt;
  }

  /// That the time was up within a level, what is kept of it, and how long the rest probably takes.
  [[nodiscard]] std::string time_up_text(int level, const Discretisation<dim>& mesh, const Store& store,
                                         int finished) const {
    const double mesh_s = pace_.factor() * cost(unknowns_of(mesh), missing_steps(store, level)).seconds;
    return fmt::format(
        "the time was up after {} of its {} instants, which are kept; the next run goes on from there, and needs about "
        "{} for this mesh{}",
        finished, count(), duration_text(mesh_s),
        all_meshes_text(level, mesh_s, pace_.factor() * expected_after_s(level, mesh, store)));
  }

  void take(int level, const Discretisation<dim>& mesh, Level& answer) {
    LevelRecord record;
    record.element_size_m = element_size_m(scene_, choice_, level);
    if (scene_.reference.adaptive_share) {
      record.element_size_m = std::numeric_limits<double>::infinity();
      for (int cell = 0; cell < mesh.cell_count(); ++cell) {
        record.element_size_m = std::min(record.element_size_m, mesh.pressure_frame(cell).second);
      }
    }
    for (const Step& step : answer.steps) {
      record.unknowns = std::max(record.unknowns, step.unknowns);
      record.newton_iterations += step.newton_iterations;
      record.steps_cut += step.halvings;
      record.wall_s += step.wall_s;
      record.cpu_s += step.cpu_s;
      record.force_n.push_back(step.seen.force_n.norm());
      if (!step.linear_solver.empty()) result_.linear_solver = step.linear_solver;
    }
    record.pressure_peak_pa = std::move(answer.pressure_peaks_pa);
    record.contact_half_axes_m = std::move(answer.half_axes_m);
    edge_spacings_m_ = std::move(answer.edge_spacings_m);
    fill_records(scene_, times_s_, answer.steps, answer.shapes, result_);
    for (int instant = 0; instant < count(); ++instant) {
      result_.instants[instant].traction_pa = answer.tractions_pa[instant];
      result_.instants[instant].pressure_peak_pa = record.pressure_peak_pa[instant];
      result_.instants[instant].contact_half_axes_m = record.contact_half_axes_m[instant];
    }
    result_.levels.push_back(std::move(record));
    tractions_pa_.push_back(std::move(answer.tractions_pa));
    result_.deepest_surface = std::move(answer.deepest_surface);
    shapes_.push_back(std::move(answer.shapes));
  }

  void unknown_uncertainty() {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    for (scene::ReferenceInstant& instant : result_.instants) {
      instant.force_uncertainty_n = unknown;
      instant.displacement_uncertainty_m.setConstant(rest_points_m_.cols(), unknown);
      instant.traction_uncertainty_pa.setConstant(rest_points_m_.cols(), unknown);
      instant.pressure_peak_uncertainty_pa = unknown;
      instant.contact_half_axes_uncertainty_m.setConstant(unknown);
    }
    sum_up_uncertainty();
  }

  void estimate_uncertainty() {
    std::vector<int> unknowns;
    std::vector<std::vector<double>> forces_n, pressure_peaks_pa;
    std::array<std::vector<std::vector<double>>, 2> half_axes_m;
    for (int level = 0; level < solved_levels(); ++level) {
      unknowns.push_back(result_.levels[level].unknowns);
      forces_n.push_back(result_.levels[level].force_n);
      pressure_peaks_pa.push_back(result_.levels[level].pressure_peak_pa);
      for (int axis = 0; axis < 2; ++axis) {
        std::vector<double>& lengths_m = half_axes_m[axis].emplace_back();
        for (const Eigen::Vector2d& both_m : result_.levels[level].contact_half_axes_m) {
          lengths_m.push_back(both_m[axis]);
        }
      }
    }
    const std::vector<double> finer = fineness(scene_, dim, unknowns);
    const std::vector<double> bands_n = force_band(forces_n, finer, force_rule(scene_, dim, result_.instants)),
                              peak_bands_pa = force_band(pressure_peaks_pa, finer),
                              long_bands_m = force_band(half_axes_m[0], finer),
                              short_bands_m = force_band(half_axes_m[1], finer);
    std::vector<Eigen::VectorXd> bands_m = point_band(shapes_, finer), bands_pa = point_band(tractions_pa_, finer);
    for (std::size_t i = 0; i < result_.instants.size(); ++i) {
      result_.instants[i].force_uncertainty_n = bands_n[i];
      result_.instants[i].displacement_uncertainty_m = std::move(bands_m[i]);
      result_.instants[i].traction_uncertainty_pa = std::move(bands_pa[i]);
      result_.instants[i].pressure_peak_uncertainty_pa = peak_bands_pa[i];
      result_.instants[i].contact_half_axes_uncertainty_m = {long_bands_m[i], short_bands_m[i]};
      result_.instants[i].contact_half_axes_uncertainty_m.array() += edge_share_of_spacing * edge_spacings_m_[i];
    }
    add_sensitivities(solved_levels() - 1);
    sum_up_uncertainty();
  }

  void sum_up_uncertainty() {
    result_.force_uncertainty_rel = force_uncertainty_rel(result_.instants);
    result_.shape_uncertainty_rel = shape_uncertainty_rel(result_.instants, options_.rest_area_m2);
  }

  /// Reads what the store has and solves the rest, in track order. @throws TimeIsUp with the answer up to there
  void solve_level(int level, const Discretisation<dim>& mesh, const Store& store, Level& answer) {
    const SurfaceSampler<dim> sampler(mesh, rest_points_m_, choice_.mirror_x, choice_.mirror_y);
    std::optional<ContactProblem<dim>> problem;  // only when there is contact
    bool begun = false;                          // to solve something
    const auto need_problem = [&] {
      if (problem) return;
      problem.emplace(mesh, scene_.body.material, scene_.reference.kinematics, choice_.mirror_x, choice_.mirror_y);
      if (scene_.contact.friction) problem->set_friction(*scene_.contact.friction, scene_.contact.r_th_m);
    };
    std::optional<Prolongation<dim>> prolongation;
    std::optional<Solved<dim>> before, current;
    const int deepest = deepest_instant();
    Ahead ahead{.step_s = cost(unknowns_of(mesh), 1).seconds};
    for (int instant = 0; instant < count(); ++instant) {
      check_stop();
      std::optional<std::pair<Solved<dim>, Step>> found;
      if (const auto record = store.read(level, instant)) found = from_record<dim>(*record, mesh);
      if (!found) {
        check_time();
        result_.from_store = false;
        ahead.steps_after = static_cast<int>(std::count_if(depths_m_.begin() + instant + 1, depths_m_.end(),
                                                           [](double depth_m) { return depth_m > 0.0; }));
        need_problem();
        if (!begun) {
          begun = true;
          if (level > 0 && !scene_.contact.friction) prolongation.emplace(*coarser_, mesh);
          ahead.later_s = expected_after_s(level, mesh, store);
          show({.level = level + 1,
                .instant = instant + 1,
                .instants = count(),
                .depth_m = depths_m_[instant],
                .unknowns = problem->unknowns(),
                .seconds_left = seconds_left(ahead, 0.0),
                .event = true,
                .note = instant > 0 ? "resumed" : "begins"});
        }
        std::optional<State<dim>> start;
        if (prolongation) start = start_state(*prolongation, store, level, instant);
        found = solve_instant(*problem, level, instant, std::move(start), before, current, ahead);
        store.write(level, instant, to_record(found->first, found->second));
        if (found->first.touching) pace_.finished(ahead.step_s, found->second.wall_s);
        show({.level = level + 1,
              .instant = instant + 1,
              .instants = count(),
              .depth_m = depths_m_[instant],
              .newton = found->second.newton_iterations,
              .unknowns = found->second.unknowns,
              .seconds_left = pace_.factor() * ahead.after_s(),
              .step_finished = true});
      } else if (found->first.touching) {
        pace_.finished(ahead.step_s, found->second.wall_s);
      }
      answer.shapes.push_back(sampler.at_points(found->first.state.u_m));
      ContactTraction<dim> traction{Nodal::Zero(dim, mesh.node_count())};
      answer.half_axes_m.emplace_back(Eigen::Vector2d::Zero());
      answer.edge_spacings_m.push_back(edge_spacing_m(mesh, found->first.state.touching));
      if (found->first.touching) {
        need_problem();
        problem->set_tool(tool_anywhere(times_s_[instant]));
        traction = problem->contact_traction(found->first.state);
        answer.half_axes_m.back() = problem->observe(found->first.state, scene_.contact.r_th_m).half_axes_m();
      }
      answer.tractions_pa.push_back(sampler.at_points(traction.nodal_pa));
      answer.pressure_peaks_pa.push_back(traction.pressure_peak_pa);
      if (instant == deepest) {
        answer.deepest_surface =
            boundary_surface<dim>(mesh, found->first.state.u_m, traction.nodal_pa, choice_.mirror_x, choice_.mirror_y);
      }
      answer.steps.push_back(std::move(found->second));
      before = std::move(current);
      current = std::move(found->first);
    }
  }

  /// The coarser level's solution on this level's mesh; nothing when the tool did not touch there.
  [[nodiscard]] std::optional<State<dim>> start_state(const Prolongation<dim>& prolongation, const Store& store,
                                                      int level, int instant) const {
    const std::optional<std::string> record = store.read(level - 1, instant);
    const auto coarse = record ? from_record<dim>(*record, *coarser_) : std::nullopt;
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
  std::pair<Solved<dim>, Step> solve_instant(ContactProblem<dim>& problem, int level, int instant,
                                             std::optional<State<dim>> start, const std::optional<Solved<dim>>& before,
                                             const std::optional<Solved<dim>>& current, const Ahead& ahead) {
    const double time_s = times_s_[instant];
    const scene::Stopwatch begin;
    std::pair<Solved<dim>, Step> result{{time_s, problem.rest(), false}, {}};
    auto& [solved, step] = result;
    step.unknowns = problem.unknowns();
    Progress progress{.level = level + 1,
                      .instant = instant + 1,
                      .instants = count(),
                      .depth_m = depths_m_[instant],
                      .unknowns = problem.unknowns()};
    const auto watch = [&](int iteration, double residual_rel) {
      progress.newton = iteration;
      progress.residual_rel = residual_rel;
      progress.seconds_left = seconds_left(ahead, begin.wall_s());
      show(progress);
      check_stop();
      check_time();
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
            Progress halved = progress;
            halved.note = fmt::format("load step halved at t = {:g} s", failed_s);
            show(halved);
          });
      step.newton_iterations += report.newton_iterations;
      step.halvings = report.halvings;
      step.indefinite += report.indefinite;
      if (!report.converged) {
        const std::string where = stuck_contact_text(problem, path.stuck()->state, scene_.contact.r_th_m);
        throw NotConverged(not_converged_text(level, instant, report, where));
      }
    }
    if (solved.touching) {
      step.seen = problem.observe(solved.state, scene_.contact.r_th_m);
      step.linear_solver = problem.linear_solver();
    }
    step.wall_s = begin.wall_s();
    step.cpu_s = begin.cpu_s();
    return result;
  }

  /// On the coarsest level at the deepest instant, from the store where they are known.
  /// @returns why they are not known, if they are not
  std::optional<Limit> measure_sensitivities(const Store& store) {
    const int instant = deepest();
    if (result_.levels[0].force_n[instant] == 0.0) return std::nullopt;
    const std::vector<SensitivityWork> missing = missing_sensitivities(coarsest_, store);
    if (std::optional<Limit> limit = limit_before(missing)) return limit;
    const auto stored = [&](int which) {
      const std::optional<std::string> record = which < 0 ? std::nullopt : store.read(0, which);
      return record ? from_record<dim>(*record, coarsest_) : std::nullopt;
    };
    const auto at = stored(instant), before = stored(instant - 1);
    if (!at) return {};
    const std::vector<double> times_s(times_s_.begin(), times_s_.begin() + instant + 1);
    const double later_s =
        missing.empty() ? 0.0 : expected_after_s(solved_levels() - 1, *coarser_, store) - expected_s(missing, 0);
    std::size_t now = missing.size();  // the one being measured
    scene::Stopwatch began;
    const auto watch = [&](const std::string& part, int) {
      result_.from_store = false;
      check_stop();
      check_time();
      const bool next = now == missing.size() || missing[now].part != part;
      if (next) {
        now = std::find_if(missing.begin(), missing.end(), [&](const auto& one) { return one.part == part; }) -
              missing.begin();
        began = {};
      }
      const Ahead ahead{.step_s = expected_s(missing, now) - expected_s(missing, now + 1),
                        .later_s = expected_s(missing, now + 1) + later_s};
      show({.instants = count(),
            .seconds_left = seconds_left(ahead, began.wall_s()),
            .event = next,
            .note = "sensitivity to the " + part});
    };
    try {
      result_.sensitivities =
          sensitivities<dim>({scene_, choice_, coarsest_, rest_points_m_, options_.rest_area_m2, times_s, at->first,
                              at->second.seen.force_n, before ? &before->first : nullptr},
                             store, watch);
    } catch (const TimeIsUp&) {
      return Limit{EndedBy::time,
                   "the time was up before all sensitivities were measured, which it needs; the next run goes on from "
                   "there, and needs about " +
                       duration_text(pace_.factor() * expected_s(missing_sensitivities(coarsest_, store), 0))};
    } catch (const NotConverged& failure) {
      return Limit{EndedBy::sensitivity, std::string(failure.what()) + "; more instants may help"};
    } catch (const std::bad_alloc&) {
      return Limit{EndedBy::memory, "the memory did not suffice for the sensitivities, which it needs"};
    }
    sensitivities_known_ = true;
    return std::nullopt;
  }

  /// Expected time of these from the one at a place on, before the run's own pace [s].
  [[nodiscard]] static double expected_s(const std::vector<SensitivityWork>& work, std::size_t from) {
    double seconds = 0.0;
    for (std::size_t i = from; i < work.size(); ++i) seconds += expected_cost(work[i].work, ranks::threads()).seconds;
    return seconds;
  }

  /// What forbids to begin with the sensitivities, if anything does.
  [[nodiscard]] std::optional<Limit> limit_before(const std::vector<SensitivityWork>& missing) const {
    double memory_bytes = 0.0;
    for (const SensitivityWork& one : missing) {
      memory_bytes = std::max(memory_bytes, expected_memory_bytes(dim, one.work.unknowns));
    }
    const std::string needs = "the sensitivities, which it needs, would take about ";
    if (memory_bytes > memory_limit_bytes()) {
      return Limit{EndedBy::memory,
                   needs + memory_text(memory_bytes) + " of memory, more than " + memory_text(memory_limit_bytes())};
    }
    const double needed_s = pace_.factor() * expected_s(missing, 0);
    if (!missing.empty() && needed_s > seconds_to_go()) {
      return Limit{EndedBy::time, needs + duration_text(needed_s) + ", more than the " +
                                      duration_text(std::max(0.0, seconds_to_go())) + " left"};
    }
    return std::nullopt;
  }

  /// What the differences of the levels do not show.
  void add_sensitivities(int finest) {
    double deepest_m = 0.0;
    for (const auto& instant : result_.instants) deepest_m = std::max(deepest_m, instant.depth_m);
    for (const Sensitivity& one : result_.sensitivities) {
      const double share = share_at(one, finest);
      if (share == 0.0) continue;
      for (std::size_t i = 0; i < result_.instants.size(); ++i) {
        result_.instants[i].force_uncertainty_n += share * one.force_rel * result_.instants[i].force_n().norm();
        result_.instants[i].displacement_uncertainty_m +=
            share * result_.instants[i].depth_m / deepest_m * one.displacement_change_m;
        // Of tractions and the contact's size they are not measured: as much as of the force.
        result_.instants[i].traction_uncertainty_pa +=
            share * one.force_rel * result_.instants[i].traction_pa.colwise().norm().transpose();
        result_.instants[i].pressure_peak_uncertainty_pa +=
            share * one.force_rel * result_.instants[i].pressure_peak_pa;
        result_.instants[i].contact_half_axes_uncertainty_m +=
            share * one.force_rel * result_.instants[i].contact_half_axes_m;
      }
    }
  }

  [[nodiscard]] std::string not_converged_text(int level, int instant, const AdvanceReport& report,
                                               const std::string& where) const {
    return fmt::format(
        "instant {} of {} (t = {:g} s, depth {:g} m) did not converge on level {}: {}, residual {:g} of the acting "
        "forces (asked: {:g}), stuck at t = {:g} s after {} halvings, {}. Finished steps are kept. Try a smaller "
        "reference.element_size_m (now {:g} m on the coarsest level), more instants, or less depth.",
        instant + 1, count(), times_s_[instant], depth_m(times_s_[instant]), level + 1, report.last.trouble,
        report.last.residual_rel, ContactProblem<dim>::force_tolerance, report.stuck_time_s, report.halvings, where,
        element_size_m(scene_, choice_, 0));
  }

  const Scene& scene_;
  const ModelChoice& choice_;
  const Eigen::Matrix3Xd& rest_points_m_;
  const Options& options_;
  std::unique_ptr<const scene::Shape> body_;
  std::vector<double> times_s_;
  scene::Stopwatch begin_;
  std::vector<double> depths_m_;  // of the tool in the body at rest, per instant
  Pace pace_;
  Result result_;
  std::unique_ptr<Discretisation<dim>> coarser_;  // of the level solved last
  Discretisation<dim> coarsest_;
  std::vector<std::vector<Eigen::Matrix3Xd>> shapes_, tractions_pa_;  // per level and instant, 3 x rest points
  std::vector<double> edge_spacings_m_;                               // per instant on the finest mesh so far
  bool sensitivities_known_ = false;
  std::string why_unknown_;  // the uncertainty of three meshes and more
};

}  // namespace

Result run(const Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m, const Options& options,
           const scene::Stopwatch& begin) {
  if (choice.dim == 2) return Run<2>(scene, choice, rest_points_m, options, begin).answer();
  return Run<3>(scene, choice, rest_points_m, options, begin).answer();
}

}  // namespace touchstone::reference
