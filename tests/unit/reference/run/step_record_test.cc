#include "reference/run/step_record.h"

#include "scene/base/hash.h"

#include <gtest/gtest.h>

#include <string>

namespace touchstone::reference {
namespace {

constexpr int cells = 2;
constexpr int nodes = 15;

Discretisation<2> mesh_of_two_cells() {
  Discretisation<2> mesh;
  mesh.points_m.setZero(2, nodes);
  mesh.cells.resize(cells);
  return mesh;
}

/// Numbers that all differ.
std::pair<Solved<2>, Step> known_step(bool friction) {
  double last = 0.0;
  const auto next = [&last] { return last += 0.1; };
  const auto fill = [&](auto& values) {
    for (auto& value : values.reshaped()) value = next();
  };
  std::pair<Solved<2>, Step> result;
  auto& [solved, step] = result;
  solved.time_s = next();
  solved.touching = true;
  solved.state.u_m.resize(2, nodes);
  solved.state.p_pa.resize(3, cells);
  fill(solved.state.u_m);
  fill(solved.state.p_pa);
  solved.state.touching.assign(nodes, 0);
  solved.state.touching[3] = 1;
  for (scene::Vec3* vector : {&step.seen.force_n, &step.seen.torque_nm, &step.seen.support_force_n}) fill(*vector);
  for (double* value : {&step.seen.area_m2, &step.seen.contact_radius_m, &step.seen.node_penetration_m,
                        &step.seen.between_nodes_penetration_m, &step.seen.equilibrium_rel,
                        &step.seen.volume_change_rel, &step.wall_s, &step.cpu_s}) {
    *value = next();
  }
  step.unknowns = 11;
  step.newton_iterations = 12;
  step.halvings = 13;
  step.indefinite = 14;
  step.linear_solver = "a solver";
  step.seen.regions.resize(2);
  for (ContactRegion& region : step.seen.regions) {
    for (scene::Vec3* vector : {&region.force_n, &region.torque_nm, &region.center_m}) fill(*vector);
    region.area_m2 = next();
  }
  if (!friction) return result;
  solved.state.slipping.assign(nodes, 0);
  solved.state.sliding.assign(nodes, 0);
  solved.state.slipping[4] = solved.state.sliding[5] = 1;
  solved.state.on_tool_m.resize(3, nodes);
  fill(solved.state.on_tool_m);
  solved.state.dissipated_j = step.seen.dissipated_j = next();
  for (ContactRegion& region : step.seen.regions) {
    fill(region.friction_n);
    region.stuck_share = next();
  }
  return result;
}

std::string bytes_of(bool friction) {
  const auto [solved, step] = known_step(friction);
  return to_record(solved, step);
}

TEST(StepRecord, BytesAreThoseOfEarlierVersions) {
  EXPECT_EQ(scene::hash_text(bytes_of(false)), "cfb7cb06d1cc047a5be1ea22193ac842");
  EXPECT_EQ(scene::hash_text(bytes_of(true)), "80bb72cff9152181a57286852e72dd90");
}

TEST(StepRecord, GivesBackEveryBit) {
  for (const bool friction : {false, true}) {
    const std::string bytes = bytes_of(friction);
    const auto back = from_record<2>(bytes, mesh_of_two_cells());
    ASSERT_TRUE(back);
    EXPECT_EQ(to_record(back->first, back->second), bytes);
    const auto [solved, step] = known_step(friction);
    EXPECT_TRUE(back->first.touching);
    EXPECT_EQ(back->first.state.u_m, solved.state.u_m);
    EXPECT_EQ(back->first.state.on_tool_m.cols(), friction ? nodes : 0);
    EXPECT_EQ(back->second.seen.dissipated_j, step.seen.dissipated_j);
    EXPECT_EQ(back->second.seen.regions.size(), 2U);
    EXPECT_EQ(back->second.linear_solver, "a solver");
  }
}

TEST(StepRecord, OfAnotherMeshOrLengthIsNone) {
  Discretisation<2> larger = mesh_of_two_cells();
  larger.cells.resize(cells + 1);
  EXPECT_FALSE(from_record<2>(bytes_of(false), larger));
  for (const bool friction : {false, true}) {
    const std::string bytes = bytes_of(friction);
    // What ends where friction's history begins is a record without friction.
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const bool whole = friction && size == bytes_of(false).size();
      EXPECT_EQ(from_record<2>(bytes.substr(0, size), mesh_of_two_cells()).has_value(), whole) << size;
    }
    EXPECT_FALSE(from_record<2>(bytes + '\0', mesh_of_two_cells()));
  }
}

}  // namespace
}  // namespace touchstone::reference
