#include "reference/contact/contact_model.h"

#include "reference/contact/regions.h"

#include <algorithm>
#include <numbers>

namespace touchstone::reference {

template <int dim>
ContactModel<dim>::ContactModel(const Discretisation<dim>& mesh_in, const scene::Material& material_in,
                                scene::Kinematics kinematics_in, bool mirror_x_in, bool mirror_y_in)
    : mesh(mesh_in), material(material_in), kinematics(kinematics_in), mirror_x(mirror_x_in), mirror_y(mirror_y_in) {
  const int n = mesh.node_count();
  prescribed.assign(n * dim, 0);
  prescribed_m = Nodal::Zero(dim, n);
  normal = Nodal::Zero(dim, n);
  area_m2.assign(n, 0.0);
  axis_partner.assign(n, -1);
  largest_extent_m = (mesh.points_m.rowwise().maxCoeff() - mesh.points_m.rowwise().minCoeff()).maxCoeff();

  for (const auto& face : mesh.faces) {
    for (const int node : face.nodes) {
      for (int i = 0; i < dim; ++i) {
        const bool fixed = face.boundary == Boundary::held || (face.boundary == Boundary::plane_x && i == 0) ||
                           (face.boundary == Boundary::plane_y && i == 1);
        if (fixed) prescribed[node * dim + i] = 1;
      }
    }
  }
  // Areas and normals of the surface that may touch. Lumping at the nodes keeps every weight positive.
  Nodal area = Nodal::Zero(dim, n);  // in its first row
  const auto face_geometry = mesh.face_geometry();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    if (face.boundary != Boundary::free) continue;
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a) {
      const int node = face.nodes[a];
      const double r_m = mesh.points_m(0, node);
      area(0, node) += face_geometry[f].weight[a] * (dim == 2 ? 2.0 * std::numbers::pi * r_m : 1.0);
      normal.col(node) += face_geometry[f].normal.col(a);
      // The node on the axis carries no force: alone it would flip freely, so it follows its neighbour.
      if (dim == 2 && r_m < 1e-9 * largest_extent_m) axis_partner[node] = face.nodes[1];
    }
  }
  mesh.condense(area);
  for (int node = 0; node < n; ++node) area_m2[node] = area(0, node);
  for (auto one : normal.colwise()) {
    if (!one.isZero(0.0)) one.normalize();
  }
  for (const auto& face : mesh.faces) {
    if (face.boundary == Boundary::free) {
      nodes.insert(nodes.end(), face.nodes.begin(), face.nodes.end());
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::erase_if(nodes, [&](int node) {
    bool all_fixed = true;
    for (int i = 0; i < dim; ++i) all_fixed = all_fixed && prescribed[node * dim + i];
    return mesh.hangs(node) || all_fixed;
  });
}

template <int dim>
Gap<dim> ContactModel<dim>::gap(const State<dim>& state, int node) const {
  const Point X = mesh.points_m.col(node), u = state.u_m.col(node);
  return kinematics == scene::Kinematics::finite ? tool->gap(X + u) : tool->gap_along(X, normal.col(node), u);
}

template <int dim>
typename ContactModel<dim>::Point ContactModel<dim>::place_m(const State<dim>& state, int node) const {
  if (kinematics == scene::Kinematics::small) return mesh.points_m.col(node);
  return mesh.points_m.col(node) + state.u_m.col(node);
}

template <int dim>
typename ContactModel<dim>::Point ContactModel<dim>::along_surface(int node, const Point& normal_in,
                                                                   Point vector) const {
  for (int i = 0; i < dim; ++i) {
    if (prescribed[node * dim + i]) vector[i] = 0.0;
  }
  return vector - vector.dot(normal_in) * normal_in;
}

template <int dim>
bool ContactModel<dim>::can_slip(int node) const {
  int free = 0;
  for (int i = 0; i < dim; ++i) free += prescribed[node * dim + i] ? 0 : 1;
  return free > 1;
}

template <int dim>
Touching ContactModel<dim>::touching_points(const State<dim>& state, double gap_m) const {
  Touching touching;
  std::vector<int> index(mesh.node_count(), -1);
  for (const int node : nodes) {
    if (!state.touching[node]) continue;
    index[node] = static_cast<int>(touching.nodes.size());
    touching.nodes.push_back(node);
  }
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      if ((x > 0.0 || (dim == 3 && mirror_x)) && (y > 0.0 || (dim == 3 && mirror_y))) {
        touching.mirrors.emplace_back(x, y, 1.0);
      }
    }
  }
  const int count = static_cast<int>(touching.nodes.size());
  if constexpr (dim == 3) {
    Eigen::Matrix3Xd points_m(3, count * static_cast<int>(touching.mirrors.size()));
    std::vector<std::pair<int, int>> links;
    for (std::size_t m = 0; m < touching.mirrors.size(); ++m) {
      const int first = static_cast<int>(m) * count;
      for (int i = 0; i < count; ++i) {
        points_m.col(first + i) = touching.mirrors[m].cwiseProduct(place_m(state, touching.nodes[i]));
      }
      for (const auto& face : mesh.faces) {
        int before = -1;
        for (const int node : face.nodes) {
          const int here = index[node];
          if (here >= 0 && before >= 0) links.emplace_back(first + before, first + here);
          if (here >= 0) before = here;
        }
      }
    }
    touching.region_of = region_of_points(points_m, links, gap_m);
  } else {
    touching.region_of.assign(count, 0);
  }
  return touching;
}

template <int dim>
std::vector<NodeContact<dim>> ContactModel<dim>::contacts_of(const State<dim>& state, const Nodal& forces_n,
                                                             const Touching& touching) const {
  const int count = static_cast<int>(touching.nodes.size());
  std::vector<NodeContact<dim>> contacts(count);
  for (int i = 0; i < count; ++i) {
    NodeContact<dim>& contact = contacts[i];
    const int node = contact.node = touching.nodes[i];
    contact.normal = gap(state, node).gradient;
    for (int k = 0; k < dim; ++k) {
      if (prescribed[node * dim + k]) contact.normal[k] = 0.0;
    }
    contact.normal.normalize();
    contact.normal_n = contact.normal.dot(forces_n.col(node));
    contact.friction_n = along_surface(node, contact.normal, forces_n.col(node));
    contact.slips = friction && !state.slipping.empty() && state.slipping[node];
    contact.region = touching.region_of[i];
  }
  if (!friction || count == 0) return contacts;
  std::vector<double> normal_n(1 + *std::max_element(touching.region_of.begin(), touching.region_of.end()), 0.0);
  std::vector<char> sliding(normal_n.size(), 0);
  for (std::size_t point = 0; point < touching.region_of.size(); ++point) {
    const NodeContact<dim>& contact = contacts[point % count];
    normal_n[touching.region_of[point]] += contact.normal_n;
    if (!state.sliding.empty() && state.sliding[contact.node]) sliding[touching.region_of[point]] = 1;
  }
  // Lower bound of the normal force, so that the coefficient is finite before the contact carries load.
  for (NodeContact<dim>& contact : contacts) {
    contact.coefficient =
        friction->coefficient(std::max(normal_n[contact.region], smallest_force_n()), sliding[contact.region] != 0);
  }
  return contacts;
}

template <int dim>
void ContactModel<dim>::note_places(const RigidTool<dim>& at, State<dim>& state) const {
  state.on_tool_m = Eigen::Matrix3Xd::Zero(3, mesh.node_count());
  for (const int node : nodes) {
    state.on_tool_m.col(node) = at.in_tool_frame(mesh.points_m.col(node) + state.u_m.col(node));
  }
}

template struct ContactModel<2>;
template struct ContactModel<3>;

}  // namespace touchstone::reference
