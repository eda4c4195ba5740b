// Where a load step fails to converge, as text for the user.
#pragma once

#include "reference/contact/contact_problem.h"
#include "scene/base/in_space.h"

#include <fmt/format.h>

#include <string>

namespace touchstone::reference {

/// The contact regions of an unfinished state, and which of them lies nearest to the place that is farthest from
/// balance: "contact region 2 of 2, around (0.012, 0, 0.058) m with 3.4 N, next to the largest out-of-balance force at
/// (...) m".
/// @param region_gap_m  as for ContactProblem::observe
template <int dim>
std::string stuck_contact_text(const ContactProblem<dim>& problem, const State<dim>& state, double region_gap_m) {
  const Discretisation<dim>& mesh = problem.mesh();
  const auto F = problem.internal_forces(state);
  std::vector<char> bound = state.touching;
  for (const auto& face : mesh.faces) {
    if (face.boundary == Boundary::free) continue;
    for (const int node : face.nodes) bound[node] = 1;
  }
  // Nodes bound by nothing: all the internal force there is out of balance.
  int worst = -1;
  double worst_n = 0.0;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (bound[node] || !(F.col(node).norm() > worst_n)) continue;
    worst = node;
    worst_n = F.col(node).norm();
  }
  const std::vector<ContactRegion> regions = problem.observe(state, region_gap_m).regions;
  if (worst < 0 || regions.empty()) return "no contact region has formed";
  const scene::Vec3 worst_m = scene::in_space<dim>(mesh.points_m.col(worst) + state.u_m.col(worst));
  std::size_t nearest = 0;
  for (std::size_t r = 1; r < regions.size(); ++r) {
    if ((regions[r].center_m - worst_m).norm() < (regions[nearest].center_m - worst_m).norm()) nearest = r;
  }
  const auto place = [](const scene::Vec3& at_m) {
    return fmt::format("({:.3g}, {:.3g}, {:.3g}) m", at_m.x(), at_m.y(), at_m.z());
  };
  return fmt::format("contact region {} of {}, around {} with {:.3g} N, next to the largest out-of-balance force at {}",
                     nearest + 1, regions.size(), place(regions[nearest].center_m), regions[nearest].force_n.norm(),
                     place(worst_m));
}

}  // namespace touchstone::reference
