#include "reference/verification/solids.h"

#include "reference/solver.h"
#include "reference/verification/closed_forms.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::verification {

using reference::Boundary;
using reference::ContactProblem;
using reference::Mesh;
using reference::State;

template <int dim>
Mesh<dim> lattice_mesh(const std::array<int, dim>& cells, const std::function<Place<dim>(const Place<dim>&)>& place_m) {
  using Index = Eigen::Matrix<int, dim, 1>;
  // Indices of a lattice with so many points per side, the first coordinate fastest.
  const auto coordinates = [](int number, const Index& sides) {
    Index at;
    for (int d = 0; d < dim; ++d) {
      at[d] = number % sides[d];
      number /= sides[d];
    }
    return at;
  };
  const Index cell_sides = Eigen::Map<const Index>(cells.data());
  const Index node_sides = 2 * cell_sides.array() + 1;
  Mesh<dim> mesh;
  mesh.points_m.resize(dim, node_sides.prod());
  for (int node = 0; node < mesh.node_count(); ++node) {
    mesh.points_m.col(node) = place_m(
        coordinates(node, node_sides).template cast<double>().cwiseQuotient(2.0 * cell_sides.template cast<double>()));
  }
  for (int number = 0; number < cell_sides.prod(); ++number) {
    const Index at = coordinates(number, cell_sides);
    std::array<int, Mesh<dim>::nodes_per_cell> cell;
    for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
      const Index node = 2 * at + coordinates(a, Index::Constant(3));
      cell[a] = 0;
      for (int d = dim - 1; d >= 0; --d) cell[a] = cell[a] * node_sides[d] + node[d];
    }
    mesh.cells.push_back(cell);
    for (int d = 0; d < dim; ++d) {
      for (const bool upper : {false, true}) {
        if (at[d] != (upper ? cell_sides[d] - 1 : 0)) continue;
        typename Mesh<dim>::Face face{{}, Boundary::free};
        int next = 0;
        for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
          if (coordinates(a, Index::Constant(3))[d] == (upper ? 2 : 0)) face.nodes[next++] = cell[a];
        }
        mesh.faces.push_back(face);
      }
    }
  }
  return mesh;
}

Mesh<3> graded_cube(double side_m) {
  reference::BlockSpec spec{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(side_m), true, true, {}};
  spec.grading = {{{{0.0, 0.0, side_m}, {0.0, 0.0, 1.0}, 0.1 * side_m, 0.125 * side_m}}, 0.5, 0.5 * side_m};
  Mesh<3> mesh = reference::block_mesh(spec);
  free_all_boundaries(mesh);
  return mesh;
}

Mesh<3> distorted_cube(double side_m) {
  return lattice_mesh<3>({2, 2, 2}, [side_m](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::Array3d share = 1.0 - 2.0 * (x.array() - 0.5).abs();
    return side_m * (x + share.prod() * Eigen::Vector3d(0.12, -0.09, 0.06));
  });
}

template <int dim>
void free_all_boundaries(Mesh<dim>& mesh) {
  for (auto& face : mesh.faces) face.boundary = Boundary::free;
}

Nodal<3> traction_force_n(const Mesh<3>& mesh, const Eigen::Vector3d& traction_pa,
                          const std::function<bool(const Eigen::Vector3d&)>& on) {
  Nodal<3> force_n = Nodal<3>::Zero(3, mesh.node_count());
  const reference::GaussRule<2> rule;
  for (const auto& face : mesh.faces) {
    if (!on(mesh.points_m.col(face.nodes[4]))) continue;
    Eigen::Matrix<double, 3, 9> X_m;
    for (int a = 0; a < 9; ++a) X_m.col(a) = mesh.points_m.col(face.nodes[a]);
    for (int q = 0; q < reference::GaussRule<2>::size; ++q) {
      const reference::Q2<2> shape(rule.points[q]);
      const Eigen::Matrix<double, 3, 2> tangents = X_m * shape.gradient;
      const double area_m2 = rule.weights[q] * tangents.col(0).cross(tangents.col(1)).norm();
      for (int a = 0; a < 9; ++a) force_n.col(face.nodes[a]) += area_m2 * shape.value[a] * traction_pa;
    }
  }
  return force_n;
}

template <int dim>
std::vector<int> nodes_where(const Mesh<dim>& mesh, const std::function<bool(const Place<dim>&)>& on) {
  std::vector<char> hangs(mesh.node_count(), 0);
  for (const auto& hanging : mesh.hanging) hangs[hanging.node] = 1;
  std::vector<int> nodes;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (!hangs[node] && on(mesh.points_m.col(node))) nodes.push_back(node);
  }
  return nodes;
}

template <int dim>
int node_at(const Mesh<dim>& mesh, const Place<dim>& place_m) {
  Eigen::Index nearest = 0;
  (mesh.points_m.colwise() - place_m).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

template <int dim>
void advance(ContactProblem<dim>& body, State<dim>& state, const std::string& what) {
  const reference::NewtonReport report = body.solve(state);
  if (!report.converged) throw reference::NotConverged(what + ": " + report.trouble);
}

template <int dim>
State<dim> solve_in_steps(ContactProblem<dim>& body, int steps, const std::string& what,
                          const std::function<void(double)>& set) {
  State<dim> state = body.rest();
  for (int step = 1; step <= steps; ++step) {
    set(static_cast<double>(step) / steps);
    advance(body, state, what + ", step " + std::to_string(step) + " of " + std::to_string(steps));
  }
  return state;
}

double axis_pressure_pa(const ContactProblem<2>& body, const State<2>& state, scene::Kinematics kinematics) {
  const Mesh<2>& mesh = body.mesh();
  const Nodal<2> F_n = body.internal_forces(state);
  Nodal<2> x_m = mesh.points_m;
  if (kinematics == scene::Kinematics::finite) x_m += state.u_m;
  for (const auto& face : mesh.faces) {
    const int middle = face.nodes[1];
    const double near_m = std::min(mesh.points_m(0, face.nodes[0]), mesh.points_m(0, face.nodes[2]));
    if (face.boundary != Boundary::free || near_m > 1e-6 * mesh.points_m(0, middle) || !state.touching[middle]) {
      continue;
    }
    const double wide_m = std::max(x_m(0, face.nodes[0]), x_m(0, face.nodes[2]));
    return -F_n(1, middle) / (4.0 / 6.0 * 2.0 * std::numbers::pi * x_m(0, middle) * wide_m);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

template <int dim>
PatchDeviation patch_deviation(Mesh<dim> mesh, const Eigen::Matrix<double, dim, dim>& H,
                               const scene::Material& material, scene::Kinematics kinematics) {
  free_all_boundaries(mesh);
  std::vector<char> boundary(mesh.node_count(), 0);
  for (const auto& face : mesh.faces) {
    for (const int node : face.nodes) boundary[node] = 1;
  }
  for (const auto& hanging : mesh.hanging) boundary[hanging.node] = 0;
  const Nodal<dim> exact_m = H * mesh.points_m;
  ContactProblem<dim> body(mesh, material, kinematics, false, false);
  for (int node = 0; node < mesh.node_count(); ++node) {
    for (int i = 0; i < dim && boundary[node]; ++i) body.prescribe(node, i, exact_m(i, node));
  }
  const State<dim> state = solve_in_steps<dim>(body, 1, "patch test", [](double) {});
  const double size_m = (mesh.points_m.rowwise().maxCoeff() - mesh.points_m.rowwise().minCoeff()).maxCoeff();
  const auto mean_pa = state.p_pa.row(0).array() - state.p_pa(0, 0);
  return {(state.u_m - exact_m).cwiseAbs().maxCoeff() / size_m,
          std::max(mean_pa.abs().maxCoeff(), state.p_pa.bottomRows(dim).cwiseAbs().maxCoeff()) /
              material.youngs_modulus_pa};
}

PulledBar pull_bar(const scene::Material& material, double stretch) {
  constexpr double side_m = 0.02;
  const Mesh<3> mesh = distorted_cube(side_m);
  const auto near = [](double a_m, double b_m) { return std::abs(a_m - b_m) < 1e-9 * side_m; };
  ContactProblem<3> body(mesh, material, scene::Kinematics::finite, true, true);
  for (const int i : {0, 1, 2}) {
    for (const int node : nodes_where<3>(mesh, [&](const auto& x_m) { return near(x_m[i], 0.0); })) {
      body.prescribe(node, i, 0.0);
    }
  }
  const std::vector<int> top = nodes_where<3>(mesh, [&](const auto& x_m) { return near(x_m[2], side_m); });
  const State<3> state = solve_in_steps<3>(body, 4, "bar", [&](double share) {
    for (const int node : top) body.prescribe(node, 2, share * (stretch - 1.0) * side_m);
  });
  const Nodal<3> F_n = body.internal_forces(state);
  double force_n = 0.0;
  for (const int node : top) force_n += F_n(2, node);
  return {force_n / (side_m * side_m), body.observe(state).volume_change_rel};
}

InflatedSphere inflate_sphere(double stretch, int n) {
  constexpr double A_m = 0.01, B_m = 0.02;
  const scene::Material rubber{3e6, 0.5};
  // Upper half of the sphere in its meridian plane: radius, then angle from the equator's plane up to the axis.
  Mesh<2> mesh = lattice_mesh<2>({n, n}, [](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    const double R_m = A_m + (B_m - A_m) * x[0], angle = 0.5 * std::numbers::pi * x[1];
    return {x[1] == 1.0 ? 0.0 : R_m * std::cos(angle), R_m * std::sin(angle)};
  });
  for (auto& face : mesh.faces) {
    if (mesh.points_m(0, face.nodes[1]) == 0.0) face.boundary = Boundary::plane_x;
  }
  ContactProblem<2> body(mesh, rubber, scene::Kinematics::finite, false, false);
  const std::vector<int> equator = nodes_where<2>(mesh, [](const auto& x_m) { return x_m[1] == 0.0; });
  const std::vector<int> inner = nodes_where<2>(mesh, [](const auto& x_m) { return x_m.norm() < 1.000001 * A_m; });
  for (const int node : equator) body.prescribe(node, 1, 0.0);
  const int steps = static_cast<int>(std::ceil((stretch - 1.0) / 0.25));
  const State<2> state = solve_in_steps<2>(body, steps, "thick sphere", [&](double share) {
    for (const int node : inner) {
      for (const int i : {0, 1}) body.prescribe(node, i, share * (stretch - 1.0) * mesh.points_m(i, node));
    }
  });

  InflatedSphere sphere;
  double difference2 = 0.0, size2 = 0.0;
  const reference::GaussRule<2> rule;
  for (const auto& cell : mesh.cells) {
    Eigen::Matrix<double, 2, 9> X_m, u_m;
    for (int a = 0; a < 9; ++a) {
      X_m.col(a) = mesh.points_m.col(cell[a]);
      u_m.col(a) = state.u_m.col(cell[a]);
    }
    for (int q = 0; q < reference::GaussRule<2>::size; ++q) {
      const reference::Q2<2> shape(rule.points[q]);
      const Eigen::Vector2d place_m = X_m * shape.value;
      const double R_m = place_m.norm();
      const double weight =
          rule.weights[q] * std::abs(Eigen::Matrix2d(X_m * shape.gradient).determinant()) * place_m[0];
      const Eigen::Vector2d exact_m = place_m * (thick_sphere_radius_m(A_m, stretch, R_m) / R_m - 1.0);
      difference2 += weight * (u_m * shape.value - exact_m).squaredNorm();
      size2 += weight * exact_m.squaredNorm();
    }
  }
  sphere.displacement_error_l2 = std::sqrt(difference2 / size2);
  // Virtual work of the inner pressure in a unit radial motion: p 2 pi a^2 over the half sphere.
  const Nodal<2> F_n = body.internal_forces(state);
  double work_n = 0.0;
  for (const int node : inner) work_n += F_n.col(node).dot(mesh.points_m.col(node)) / A_m;
  sphere.inner_pressure_pa = work_n / (2.0 * std::numbers::pi * stretch * A_m * stretch * A_m);
  sphere.shear_modulus_pa = rubber.shear_modulus_pa();
  sphere.exact_pressure_pa = thick_sphere_pressure_pa(sphere.shear_modulus_pa, A_m, B_m, stretch);
  return sphere;
}

template Mesh<2> lattice_mesh<2>(const std::array<int, 2>&, const std::function<Place<2>(const Place<2>&)>&);
template Mesh<3> lattice_mesh<3>(const std::array<int, 3>&, const std::function<Place<3>(const Place<3>&)>&);
template void free_all_boundaries(Mesh<2>&);
template void free_all_boundaries(Mesh<3>&);
template std::vector<int> nodes_where(const Mesh<2>&, const std::function<bool(const Place<2>&)>&);
template std::vector<int> nodes_where(const Mesh<3>&, const std::function<bool(const Place<3>&)>&);
template int node_at(const Mesh<2>&, const Place<2>&);
template int node_at(const Mesh<3>&, const Place<3>&);
template void advance(ContactProblem<2>&, State<2>&, const std::string&);
template void advance(ContactProblem<3>&, State<3>&, const std::string&);
template State<2> solve_in_steps(ContactProblem<2>&, int, const std::string&, const std::function<void(double)>&);
template State<3> solve_in_steps(ContactProblem<3>&, int, const std::string&, const std::function<void(double)>&);
template PatchDeviation patch_deviation(Mesh<2>, const Eigen::Matrix2d&, const scene::Material&, scene::Kinematics);
template PatchDeviation patch_deviation(Mesh<3>, const Eigen::Matrix3d&, const scene::Material&, scene::Kinematics);

}  // namespace touchstone::verification
