#include "reference/linear_response.h"

#include "reference/contact/contact_problem.h"
#include "reference/mesh/sampling.h"
#include "reference/run/model_choice.h"
#include "reference/solver.h"
#include "scene/base/in_space.h"
#include "scene/shape/surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::reference {
namespace {

/// Contact nodes that the tool comes close to at some instant.
template <int dim>
std::vector<int> touchable_nodes(const scene::Scene& scene, const ModelChoice& choice,
                                 const ContactProblem<dim>& problem, double margin_rel) {
  const auto body = scene::body_shape(scene.body);
  std::vector<RigidTool<dim>> tools;
  double deepest_m = 0.0;
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    const double depth_m = scene::rest_depth_m(*body, scene.tool, pose);
    if (depth_m <= 0.0) continue;
    deepest_m = std::max(deepest_m, depth_m);
    tools.emplace_back(choice.tool, pose);
  }
  using Point = Eigen::Matrix<double, dim, 1>;
  std::vector<int> nodes;
  for (const int node : problem.contact_nodes()) {
    const Point X_m = problem.mesh().points_m.col(node), N = problem.surface_normal(node);
    const bool near = std::any_of(tools.begin(), tools.end(), [&](const RigidTool<dim>& tool) {
      return tool.gap_along(X_m, N, Point::Zero()).value_m < margin_rel * deepest_m;
    });
    if (near) nodes.push_back(node);
  }
  return nodes;
}

template <int dim>
LinearResponse condense(const scene::Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m,
                        const LinearResponseOptions& options, const std::function<void(double)>& progress) {
  ContactProblem<dim> problem(level_mesh<dim>(scene, choice, options.level), scene.body.material,
                              scene::Kinematics::small, choice.mirror_x, choice.mirror_y);
  const SurfaceSampler<dim> sampler(problem.mesh(), rest_points_m, choice.mirror_x, choice.mirror_y);
  const std::vector<int> nodes = touchable_nodes(scene, choice, problem, options.margin_rel);
  if (nodes.empty()) throw scene::InputError("the tool touches no node of the body on this track");

  const auto n = static_cast<Eigen::Index>(nodes.size());
  const bool mirror_x = dim == 3 && choice.mirror_x, mirror_y = dim == 3 && choice.mirror_y;
  const double images = (mirror_x ? 2.0 : 1.0) * (mirror_y ? 2.0 : 1.0);
  LinearResponse out;
  out.model = choice.name(scene::Kinematics::small);
  out.unknowns = problem.unknowns();
  out.nodes_m.resize(3, n);
  out.normals.resize(3, n);
  out.force_on_tool.resize(3, n);
  out.compliance_m_per_n.resize(n, n);
  out.displacement_m_per_n.resize(3 * rest_points_m.cols(), n);
  // Columns solved at a time: enough to reuse the factor while it is in the cache.
  constexpr Eigen::Index block = 32;
  for (Eigen::Index first = 0; first < n; first += block) {
    const Eigen::Index count = std::min(block, n - first);
    std::vector<typename ContactProblem<dim>::NodeForce> forces;
    for (Eigen::Index j = first; j < first + count; ++j) {
      const int node = nodes[static_cast<std::size_t>(j)];
      const Eigen::Matrix<double, dim, 1> N = problem.surface_normal(node);
      forces.push_back({node, -N});
      out.nodes_m.col(j) = scene::in_space<dim>(problem.mesh().points_m.col(node));
      out.normals.col(j) = scene::in_space<dim>(N);
      scene::Vec3 on_tool = images * scene::in_space<dim>(N);
      if (dim == 2 || mirror_x) on_tool.x() = 0.0;
      if (mirror_y) on_tool.y() = 0.0;
      out.force_on_tool.col(j) = on_tool;
    }
    const auto displacements_m = problem.linear_displacements_m(forces);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto& u_m = displacements_m[static_cast<std::size_t>(k)];
      for (Eigen::Index i = 0; i < n; ++i) {
        const int other = nodes[static_cast<std::size_t>(i)];
        out.compliance_m_per_n(i, first + k) = -problem.surface_normal(other).dot(u_m.col(other));
      }
      out.displacement_m_per_n.col(first + k) = sampler.at_points(u_m).reshaped();
    }
    if (progress) progress(static_cast<double>(first + count) / static_cast<double>(n));
  }
  // Symmetric by Betti's theorem; this removes round-off.
  out.compliance_m_per_n = (0.5 * (out.compliance_m_per_n + out.compliance_m_per_n.transpose())).eval();
  return out;
}

}  // namespace

LinearResponse linear_response(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m,
                               const LinearResponseOptions& options, const std::function<void(double)>& progress) {
  if (std::vector<scene::Fault> faults = unsupported(scene); !faults.empty()) {
    throw scene::InputError(std::move(faults));
  }
  if (scene.contact.friction) throw scene::InputError("a linear response has no friction");
  ModelChoice choice = choose_model(scene);
  if (choice.dim == 2) return condense<2>(scene, choice, rest_points_m, options, progress);
  if (options.whole_body) {
    choice.mirror_x = choice.mirror_y = false;
    follow_inclusions(scene, choice);
  }
  return condense<3>(scene, choice, rest_points_m, options, progress);
}

}  // namespace touchstone::reference
