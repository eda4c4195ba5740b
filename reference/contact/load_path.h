// Follows the tool's track from one solved instant to the next, halving the step where Newton fails.
#pragma once

#include "reference/contact/contact_problem.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

namespace touchstone::reference {

/// A solved state with the time it belongs to.
template <int dim>
struct Solved {
  double time_s = 0.0;
  State<dim> state;
  bool touching = false;
};

struct AdvanceReport {
  bool converged = true;
  int newton_iterations = 0;
  int halvings = 0;
  int indefinite = 0;
  double stuck_time_s = 0.0;  ///< time of the last failed attempt
  NewtonReport last;
};

/// Moves the body from one instant to the next along a track of tool places.
template <int dim>
class LoadPath {
 public:
  /// The tool at a time; nothing when it does not reach the body at rest. Without contact the body is at
  /// rest, whatever the history.
  using ToolAt = std::function<std::optional<RigidTool<dim>>(double time_s)>;
  using ToolAnywhere = std::function<RigidTool<dim>(double time_s)>;

  /// @param approach  the tool at any time, for friction: a node that becomes active sticks where its path over the
  ///                  tool began. Without it, the path of the first contact begins at the nearest point of the tool
  LoadPath(ContactProblem<dim>& problem, ToolAt tool_at, ToolAnywhere approach = {})
      : problem_(problem), tool_at_(std::move(tool_at)), approach_(std::move(approach)) {}

  /// Smallest step between two instants, as a fraction of their distance in time.
  static constexpr double smallest_share = 1.0 / 64.0;

  /// @param before  the instant before `from` for the linear predictor, or nullptr. Only recorded instants are passed,
  ///                so that a resumed run takes the same path as an uninterrupted one.
  /// @param on_halving  called with the time that failed
  /// @returns in `to` the state at time_s, when converged
  AdvanceReport advance(const Solved<dim>* before, const Solved<dim>& from, double time_s, Solved<dim>& to,
                        const typename ContactProblem<dim>::Watch& watch,
                        const std::function<void(double failed_time_s)>& on_halving) {
    AdvanceReport report;
    if (!tool_at_(time_s)) {
      to = {time_s, problem_.rest(), false};
      return report;
    }
    std::optional<Solved<dim>> previous;
    if (before) previous = *before;
    Solved<dim> current = from;
    double stride_s = time_s - from.time_s;
    const double smallest_s = smallest_share * stride_s;
    while (current.time_s < time_s) {
      // Take the last piece whole rather than leave a sliver.
      const bool last = current.time_s + 1.001 * stride_s >= time_s;
      const double next_s = last ? time_s : current.time_s + stride_s;
      std::optional<Solved<dim>> next = attempt(previous ? &*previous : nullptr, current, next_s, report, watch);
      if (!next && previous) next = attempt(nullptr, current, next_s, report, watch);
      if (next) {
        previous = std::move(current);
        current = std::move(*next);
        continue;
      }
      ++report.halvings;
      if (on_halving) on_halving(next_s);
      stride_s *= 0.5;
      if (stride_s < smallest_s) {
        report.converged = false;
        report.stuck_time_s = next_s;
        return report;
      }
    }
    to = std::move(current);
    return report;
  }

  /// The unfinished state of the last attempt that failed.
  [[nodiscard]] const std::optional<Solved<dim>>& stuck() const noexcept { return stuck_; }

 private:
  std::optional<Solved<dim>> attempt(const Solved<dim>* previous, const Solved<dim>& current, double time_s,
                                     AdvanceReport& report, const typename ContactProblem<dim>::Watch& watch) {
    const std::optional<RigidTool<dim>> tool = tool_at_(time_s);
    if (!tool) return Solved<dim>{time_s, problem_.rest(), false};
    problem_.set_tool(*tool);
    Solved<dim> next{time_s, current.state, true};
    if (problem_.has_friction() && !current.touching && approach_) {
      problem_.note_places(approach_(current.time_s), next.state);
    }
    if (previous && previous->touching && current.touching) {
      const double ratio = (time_s - current.time_s) / (current.time_s - previous->time_s);
      next.state.u_m += ratio * (current.state.u_m - previous->state.u_m);
      next.state.p_pa += ratio * (current.state.p_pa - previous->state.p_pa);
    }
    report.last = problem_.solve(next.state, watch);
    report.newton_iterations += report.last.iterations;
    report.indefinite += report.last.indefinite;
    if (report.last.converged) return next;
    stuck_ = std::move(next);
    return std::nullopt;
  }

  ContactProblem<dim>& problem_;
  ToolAt tool_at_;
  ToolAnywhere approach_;
  std::optional<Solved<dim>> stuck_;
};

}  // namespace touchstone::reference
