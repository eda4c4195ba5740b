#include "reference/response/smooth_response.h"

#include "reference/contact/contact_problem.h"
#include "reference/discretisation/discretisation.h"
#include "reference/mesh/inclusions.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/round_mesh.h"
#include "reference/mesh/sampling.h"
#include "scene/base/error.h"
#include "scene/response/grid_weights.h"
#include "scene/response/point_load.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace touchstone::reference {
namespace {

using scene::Mat3;
using scene::PointLoad;
using scene::Vec3;
using Nodal = Eigen::Matrix3Xd;

Discretisation<3> mesh_for(const scene::Body& body, const scene::LoadGrid& grid, double cells) {
  const double size_m = scene::body_size_m(body);
  Grading<3> grading;
  grading.growth = 1.0;
  grading.largest_m = size_m / cells;
  const double spread_m = (grid.points_m.colwise() - grid.middle_m).colwise().norm().maxCoeff();
  grading.discs.push_back(
      {grid.middle_m, grid.axes.col(2), spread_m, std::max(spread_m / cells, 0.5 * size_m / cells)});
  refine_at_inclusions(body, 4.0, grading);
  Discretisation<3> mesh;
  if (body.shape == scene::BodyShape::box) {
    BlockSpec spec;
    spec.lower_m = {-0.5 * body.size_m.x(), -0.5 * body.size_m.y(), 0.0};
    spec.upper_m = {0.5 * body.size_m.x(), 0.5 * body.size_m.y(), body.size_m.z()};
    spec.grading = grading;
    mesh = block_mesh(spec);
  } else {
    const RoundSpec spec = round_spec(body);
    if (const std::string fault = round_fault(spec); !fault.empty()) throw scene::InputError(fault);
    mesh = round_mesh(spec, grading);
  }
  embed_inclusions(body, mesh);
  return mesh;
}

/// Adds -int (sigma_k N) . v over a free face, in parts: more of them where the load is near.
/// @param near_m  distance from a double force below which its traction fades
void add_traction(const Discretisation<3>& mesh, const Discretisation<3>::Face& face, const Vec3& inside_m,
                  const PointLoad& load, const scene::Material& material, double near_m, Nodal& force_n) {
  Eigen::Matrix<double, 3, 9> X;
  for (int a = 0; a < 9; ++a) X.col(a) = mesh.points_m.col(face.nodes[static_cast<std::size_t>(a)]);
  const Vec3 middle_m = X.col(4);
  const double edge_m = (X.col(8) - X.col(0)).norm();
  const int parts = (middle_m - load.point_m).norm() < 1.5 * edge_m ? 6 : 2;
  for (int part = 0; part < parts * parts; ++part) {
    for (const GaussPoint<2>& point : gauss_points<2>()) {
      const Eigen::Vector2d xi = (point.xi + Eigen::Vector2d(part % parts, part / parts)) / parts;
      const Shape<2> shape(xi);
      const Eigen::Matrix<double, 3, 2> tangents = X * shape.gradient;
      Vec3 area_m2 = Vec3(tangents.col(0)).cross(Vec3(tangents.col(1))) * (point.weight / (parts * parts));
      const Vec3 x_m = X * shape.value;
      if (area_m2.dot(x_m - inside_m) < 0.0) area_m2 = -area_m2;
      const double distance_m = (x_m - load.point_m).norm();
      if (distance_m < 1e-6 * edge_m) continue;
      Vec3 f_n = -(scene::half_space_stress_pa(load, material, x_m) * area_m2);
      // A double force's traction on a curved face grows as 1 / distance^2. It is in balance around the load.
      if (load.apart_nm != 0.0) f_n *= std::min(std::pow(distance_m / near_m, 3), 1.0);
      for (int a = 0; a < 9; ++a) force_n.col(face.nodes[static_cast<std::size_t>(a)]) += shape.value[a] * f_n;
    }
  }
}

/// Adds int (sigma_k - sigma(u_k)) : grad v over the inclusions' part of a cell.
void add_inclusions(const Discretisation<3>& mesh, int cell, const PointLoad& load, const scene::Material& material,
                    Nodal& force_n) {
  const auto* const materials = mesh.materials_of(cell);
  if (materials == nullptr || std::all_of(materials->begin(), materials->end(), [](auto m) { return m == 0; })) return;
  const auto& nodes = mesh.cells[static_cast<std::size_t>(cell)];
  Eigen::Matrix<double, 3, 27> X;
  for (int a = 0; a < 27; ++a) X.col(a) = mesh.points_m.col(nodes[static_cast<std::size_t>(a)]);
  for (std::size_t q = 0; q < materials->size(); ++q) {
    const std::uint8_t kind = (*materials)[q];
    if (kind == 0) continue;
    const scene::Material& other = mesh.inclusion_materials[kind - 1u];
    const auto& [xi, weight, shape] = gauss_points<3>()[q];
    const Mat3 J = X * shape.gradient;
    const double volume_m3 = std::abs(J.determinant()) * weight;
    const Mat3 stress_pa = scene::half_space_stress_pa(load, material, X * shape.value);
    const double mean_pa = stress_pa.trace() / 3.0;
    Mat3 difference_pa =
        (1.0 - other.shear_modulus_pa() / material.shear_modulus_pa()) * (stress_pa - mean_pa * Mat3::Identity());
    // tr(eps) = mean / K, zero where the body is incompressible.
    const double bulk_ratio =
        material.poissons_ratio == 0.5 ? 0.0 : other.bulk_modulus_pa() / material.bulk_modulus_pa();
    difference_pa += (1.0 - bulk_ratio) * mean_pa * Mat3::Identity();
    const Eigen::Matrix<double, 27, 3> gradient = shape.gradient * J.inverse();
    for (int a = 0; a < 27; ++a) {
      force_n.col(nodes[static_cast<std::size_t>(a)]) += volume_m3 * (difference_pa * gradient.row(a).transpose());
    }
  }
}

}  // namespace

scene::Response smooth_response(const scene::Body& body, const scene::LoadGrid& grid,
                                const Eigen::Matrix3Xd& rest_points_m, const SmoothResponseOptions& options,
                                const std::function<void(const SmoothProgress&)>& progress, FirstColumns first) {
  using Next = SmoothProgress::Next;
  for (const scene::Inclusion& inclusion : body.inclusions) {
    if (inclusion.material.poissons_ratio == 0.5 && body.material.poissons_ratio != 0.5) {
      throw scene::InputError("an incompressible inclusion in a compressible body has no response of this kind");
    }
  }
  const scene::Material& material = body.material;
  if (progress) progress({Next::mesh, first});
  ContactProblem<3> problem(mesh_for(body, grid, options.cells), material, scene::Kinematics::small, false, false);
  const Discretisation<3>& mesh = problem.mesh();
  const Vec3 inside_m = mesh.points_m.rowwise().mean();
  std::vector<int> held;
  for (const auto& face : mesh.faces) {
    if (face.boundary == Boundary::held) held.insert(held.end(), face.nodes.begin(), face.nodes.end());
  }
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());

  // The rest points, then of every load its own place and two neighbours in each direction of the grid.
  const Eigen::Index m = rest_points_m.cols(), n = grid.count();
  const auto shape = scene::body_shape(body);
  const double step_m = 0.01 * scene::body_size_m(body);
  const double near_m = 0.05 * scene::body_size_m(body);  // about a cell
  Eigen::Matrix3Xd wanted_m(3, m + 5 * n);
  wanted_m.leftCols(m) = rest_points_m;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vec3 p_m = grid.points_m.col(k);
    wanted_m.col(m + 5 * k) = p_m;
    for (int side = 0; side < 4; ++side) {
      wanted_m.col(m + 5 * k + 1 + side) =
          shape->query(p_m + (side % 2 == 0 ? -step_m : step_m) * grid.axes.col(side / 2)).point_m;
    }
  }
  const SurfaceSampler<3> sampler(mesh, wanted_m, false, false);

  scene::Response& out = first.response;
  const Eigen::Index columns = options.loads.columns(grid.count());
  if (first.done == 0) {
    out.grid = grid;
    out.loads = options.loads;
    out.unknowns = problem.unknowns();
    out.smooth_m_per_n.setZero(3 * m, columns);
    out.own_m_per_n.setZero(3, columns);
    out.tilt_per_n.setZero(2, n);
  }
  if (progress) progress({Next::matrix, first});
  const auto smooth_m = [&](const PointLoad& load) -> Eigen::Matrix3Xd {
    Nodal force_n = Nodal::Zero(3, mesh.node_count());
    for (const auto& face : mesh.faces) {
      if (face.boundary == Boundary::free) add_traction(mesh, face, inside_m, load, material, near_m, force_n);
    }
    for (int cell = 0; cell < mesh.cell_count(); ++cell) add_inclusions(mesh, cell, load, material, force_n);
    problem.load(std::move(force_n));
    for (const int node : held) {
      const Vec3 u_m = scene::half_space_displacement_m(load, material, mesh.points_m.col(node));
      for (int i = 0; i < 3; ++i) problem.prescribe(node, i, -u_m[i]);
    }
    return sampler.at_points(problem.linear_displacement_m());
  };
  for (Eigen::Index column = first.done; column < columns; ++column) {
    const bool apart = column >= out.apart(0), along = !apart && column >= n;
    const Eigen::Index k = apart                ? column - out.apart(0)
                           : !along             ? column
                           : out.loads.friction ? (column - n) / 2
                                                : grid.middle();
    PointLoad load{grid.points_m.col(k), grid.normals.col(k)};
    if (apart) {
      load.force_n = 0.0;
      load.apart_nm = 1.0;
    } else if (along) {
      load.force_n = 0.0;
      load.along_n = grid.along(static_cast<int>(k)).col((column - n) % 2);
    }
    const Eigen::Matrix3Xd w_m = smooth_m(load);
    out.smooth_m_per_n.col(column) = w_m.leftCols(m).transpose().reshaped().cast<float>();
    out.own_m_per_n.col(column) = w_m.col(m + 5 * k);
    for (int axis = 0; axis < 2 && column < n; ++axis) {
      const Eigen::Index low = m + 5 * k + 1 + 2 * axis;
      const double rise_m = (w_m.col(low + 1) - w_m.col(low)).dot(load.normal);
      const double run_m = (wanted_m.col(low + 1) - wanted_m.col(low)).dot(grid.axes.col(axis));
      out.tilt_per_n(axis, k) = rise_m / run_m;
    }
    first.done = column + 1;
    if (progress) progress({Next::column, first});
  }
  if (m == 0 || grid.counts[0] < 3 || grid.counts[1] < 3) return std::move(out);
  // One load more, between the grid's points, shows what interpolation costs.
  const scene::SurfaceQuery between =
      shape->query(grid.points_m.col(grid.middle()) + 0.5 * grid.spacing_m[0] * grid.axes.col(0) +
                   0.5 * grid.spacing_m[1] * grid.axes.col(1));
  const Eigen::Matrix3Xd w_m = smooth_m({between.point_m, between.normal});
  const Eigen::VectorXd own = w_m.leftCols(m).transpose().reshaped();
  const Eigen::VectorXd interpolated =
      scene::GridWeights(grid, grid.place(between.point_m)).sum<Eigen::VectorXd>([&](int k) -> Eigen::VectorXd {
        return out.smooth_m_per_n.col(k).cast<double>();
      });
  out.interpolation_rel = (interpolated - own).norm() / own.norm();
  return std::move(out);
}

}  // namespace touchstone::reference
