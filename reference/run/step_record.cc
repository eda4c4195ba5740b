#include "reference/run/step_record.h"

#include <stdexcept>

namespace touchstone::reference {
namespace {

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

}  // namespace

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
  for (const double value : {step.seen.area_m2, step.seen.contact_radius_m, step.seen.node_penetration_m,
                             step.seen.between_nodes_penetration_m, step.seen.equilibrium_rel,
                             step.seen.volume_change_rel, step.wall_s, step.cpu_s}) {
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
                          &step.seen.volume_change_rel, &step.wall_s, &step.cpu_s}) {
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

template Record to_record(const Solved<2>&, const Step&);
template Record to_record(const Solved<3>&, const Step&);
template std::optional<std::pair<Solved<2>, Step>> from_record(Record, const Mesh<2>&);
template std::optional<std::pair<Solved<3>, Step>> from_record(Record, const Mesh<3>&);

}  // namespace touchstone::reference
