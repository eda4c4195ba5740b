// A linear model for comparison: the body as a precomputed linear compliance, the rigid tool against it
// without friction, solved exactly in every step.
//
// With gap s_i of node i at rest along its normal, compliance C and contact forces f,
//   g = s + C f,   g >= 0,   f >= 0,   g_i f_i = 0,
// which is the reference's problem of small strain on its own mesh. Solved by the primal-dual active set method from
// the last step's contact on (M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003) 865-888), a Cholesky
// factor of the active part of C updated as nodes join and leave.
#pragma once

#include "compare/model/growing_cholesky.h"
#include "reference/linear_response.h"
#include "reference/tool/tool_gap.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <vector>

namespace touchstone::compare {

class LinearContact {
 public:
  LinearContact(const reference::LinearResponse& response, const scene::Tool& tool);
  LinearContact(const LinearContact&) = delete;
  LinearContact& operator=(const LinearContact&) = delete;

  /// Force and shape for a pose of the tool.
  void step(const scene::Pose& pose);

  [[nodiscard]] const scene::Vec3& force_n() const noexcept { return force_n_; }  ///< on the tool
  [[nodiscard]] Eigen::Matrix3Xd displacement_m() const;                          ///< of the response's rest points

  /// Of the last step, per node: contact force, and gap, infinite if the node's normal misses the tool.
  [[nodiscard]] const Eigen::VectorXd& node_force_n() const noexcept { return node_force_n_; }
  [[nodiscard]] const Eigen::VectorXd& gap_m() const noexcept { return gap_m_; }
  [[nodiscard]] int nodes() const noexcept { return static_cast<int>(gap_m_.size()); }
  [[nodiscard]] int touching() const noexcept { return static_cast<int>(factor_.part().size()); }
  /// Whether the last step's contact was solved.
  [[nodiscard]] bool solved() const noexcept { return solved_; }

  /// What is kept between steps.
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  void find_rest_gaps(const scene::Pose& pose);
  void solve_touching();
  /// The next contact: releases every node with a negative force and adds every node inside the tool, or only the most
  /// violated one. If there is none, the contact is solved.
  void change_all();
  void change_worst();

  std::shared_ptr<const reference::ToolDistance> tool_;
  double ball_radius_m_ = 0.0;  ///< of a ball about its frame's origin, whose gap has a formula; 0: another tool
  Eigen::Matrix3Xd nodes_m_, normals_, force_on_tool_;
  Eigen::MatrixXd compliance_m_per_n_;
  Eigen::MatrixXf displacement_m_per_n_;
  GrowingCholesky factor_;
  Eigen::VectorXd rest_gap_m_, gap_m_, node_force_n_, part_n_;
  Eigen::VectorXf displacement_m_;
  std::vector<Eigen::Index> next_;
  scene::Vec3 force_n_ = scene::Vec3::Zero();
  bool solved_ = true;
};

}  // namespace touchstone::compare
