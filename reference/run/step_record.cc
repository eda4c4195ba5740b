#include "reference/run/step_record.h"

#include "reference/linear/record.h"

#include <stdexcept>

namespace touchstone::reference {
namespace {

/// What is kept of a step, in its order. A reader's state has the mesh's size already.
template <class Archive>
void serialize(Archive& archive, auto& solved, auto& step) {
  auto& state = solved.state;
  auto& seen = step.seen;
  int touching = solved.touching;
  archive(solved.time_s, touching);
  if constexpr (Archive::reads) solved.touching = touching != 0;
  archive.same(static_cast<int>(state.u_m.cols()));
  archive.same(static_cast<int>(state.p_pa.cols()));
  archive(state.u_m, state.p_pa, state.touching);
  archive(seen.force_n, seen.torque_nm, seen.support_force_n, seen.area_m2, seen.contact_radius_m,
          seen.node_penetration_m, seen.between_nodes_penetration_m, seen.equilibrium_rel, seen.volume_change_rel);
  archive(step.wall_s, step.cpu_s, step.unknowns, step.newton_iterations, step.halvings, step.indefinite);
  archive.size(seen.regions);
  for (auto& region : seen.regions) archive(region.force_n, region.torque_nm, region.center_m, region.area_m2);
  archive.sized(step.linear_solver);
  // Friction's history, only where there is one.
  if (!archive.more(state.on_tool_m.cols() > 0)) return;
  if constexpr (Archive::reads) {
    state.slipping = state.sliding = state.touching;
    state.on_tool_m.resize(3, state.u_m.cols());
  }
  archive(state.slipping, state.sliding, state.on_tool_m, state.dissipated_j);
  for (auto& region : seen.regions) archive(region.friction_n, region.stuck_share);
}

}  // namespace

template <int dim>
std::string to_record(const Solved<dim>& solved, const Step& step) {
  RecordWriter record;
  serialize(record, solved, step);
  return record.bytes();
}

template <int dim>
std::optional<std::pair<Solved<dim>, Step>> from_record(std::string_view bytes, const Discretisation<dim>& mesh) {
  std::pair<Solved<dim>, Step> result;
  auto& [solved, step] = result;
  solved.state.u_m.resize(dim, mesh.node_count());
  solved.state.p_pa.resize(dim + 1, mesh.cell_count());
  solved.state.touching.resize(mesh.node_count());
  try {
    RecordReader record(bytes);
    serialize(record, solved, step);
    if (record.more()) return std::nullopt;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
  step.seen.dissipated_j = solved.state.dissipated_j;
  return result;
}

template std::string to_record(const Solved<2>&, const Step&);
template std::string to_record(const Solved<3>&, const Step&);
template std::optional<std::pair<Solved<2>, Step>> from_record(std::string_view, const Discretisation<2>&);
template std::optional<std::pair<Solved<3>, Step>> from_record(std::string_view, const Discretisation<3>&);

}  // namespace touchstone::reference
