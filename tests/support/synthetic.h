// Synthetic results of both sides, similar in size and form to real ones: a ball on a cube, a reference like a half
// space, and a fast model with a cubic law and a cone as its indentation.
#pragma once

#include "compare/report/report.h"

#include <array>
#include <type_traits>
#include <vector>

namespace touchstone::compare::testing {

/// The ball on the cube of the paper, `instants` instants to a depth of 5 mm.
[[nodiscard]] scene::Scene ball_on_cube(int instants, int triangles);

/// Everything a comparison needs.
struct Sides {
  scene::Scene scene;
  fast::Run run;
  reference::Result result;
  Plans plans;
  scene::Manifest manifest;
  Call call = {};
};
[[nodiscard]] Sides pressed(int instants = 23, int triangles = 3952);

/// The same results for a scene whose tool is the shipped mallet, loaded from copies in this folder.
[[nodiscard]] Sides pressed_by_mallet(const std::filesystem::path& folder, int instants = 3);

/// Two instants at depths 1 and 10 mm, four rest points of a tetrahedron with vertex areas 1, 2, 3, 4 m^2; no
/// displacement, force or uncertainty, to be filled in.
[[nodiscard]] Sides small();

/// The page of a comparison.
[[nodiscard]] std::string report_of(const Sides& sides);

/// One region with this force on the tool, at this instant.
void set_force(scene::InstantRecord& record, const scene::Vec3& force_n);

/// Both sides' records of an instant.
[[nodiscard]] inline std::array<scene::InstantRecord*, 2> both(Sides& sides, std::size_t t) {
  return {&sides.run.instants[t], &sides.result.instants[t]};
}

/// Sets a member to the same value at all instants, or to one value for each.
template <class T>
void set_all(reference::Result& result, T scene::ReferenceInstant::*member, const std::type_identity_t<T>& value) {
  for (scene::ReferenceInstant& instant : result.instants) instant.*member = value;
}
template <class T>
void set_each(reference::Result& result, T scene::ReferenceInstant::*member,
              const std::vector<std::type_identity_t<T>>& values) {
  for (std::size_t t = 0; t < values.size(); ++t) result.instants[t].*member = values[t];
}

}  // namespace touchstone::compare::testing
