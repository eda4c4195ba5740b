#include "compare/model/linear_contact.h"

#include "reference/tool/tool_distance.h"

#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A smaller gap is round-off.
constexpr double gap_tolerance_m = 1e-13;

}  // namespace

LinearContact::LinearContact(const reference::LinearResponse& response, const scene::Tool& tool)
    : tool_(reference::tool_distance(tool)),
      ball_radius_m_(tool.shape == scene::ToolShape::sphere && !tool.mass_center_m ? tool.radius_m : 0.0),
      nodes_m_(response.nodes_m),
      normals_(response.normals),
      force_on_tool_(response.force_on_tool),
      compliance_m_per_n_(response.compliance_m_per_n),
      displacement_m_per_n_(response.displacement_m_per_n.cast<float>()),
      factor_(compliance_m_per_n_),
      rest_gap_m_(response.nodes_m.cols()),
      gap_m_(Eigen::VectorXd::Constant(response.nodes_m.cols(), infinite)),
      node_force_n_(Eigen::VectorXd::Zero(response.nodes_m.cols())),
      part_n_(response.nodes_m.cols()),
      displacement_m_(Eigen::VectorXf::Zero(response.displacement_m_per_n.rows())) {}

void LinearContact::find_rest_gaps(const scene::Pose& pose) {
  if (ball_radius_m_ > 0.0) {
    for (Eigen::Index i = 0; i < rest_gap_m_.size(); ++i) {
      const scene::Vec3 to_center_m = pose.position_m - nodes_m_.col(i);
      const double along_m = to_center_m.dot(normals_.col(i));
      const double half2_m2 = ball_radius_m_ * ball_radius_m_ - to_center_m.squaredNorm() + along_m * along_m;
      // If the ball lies entirely behind the node, the line meets it through the body; this does not count.
      const bool met = half2_m2 >= 0.0 && along_m + std::sqrt(half2_m2) >= 0.0;
      rest_gap_m_[i] = met ? along_m - std::sqrt(half2_m2) : infinite;
    }
    return;
  }
  const reference::RigidTool<3> tool(tool_, pose);
  for (Eigen::Index i = 0; i < rest_gap_m_.size(); ++i) {
    rest_gap_m_[i] = tool.gap_along(nodes_m_.col(i), normals_.col(i), scene::Vec3::Zero()).value_m;
  }
}

void LinearContact::solve_touching() {
  const std::vector<Eigen::Index>& part = factor_.part();
  auto f = part_n_.head(static_cast<Eigen::Index>(part.size()));
  for (std::size_t k = 0; k < part.size(); ++k) f[static_cast<Eigen::Index>(k)] = -rest_gap_m_[part[k]];
  factor_.solve(f);
}

void LinearContact::change_all() {
  // Single insertions and removals while few nodes change, which is the usual case.
  constexpr std::size_t few = 16;
  const std::vector<Eigen::Index>& part = factor_.part();
  next_.clear();
  for (const Eigen::Index i : part) {
    if (node_force_n_[i] >= 0.0) next_.push_back(i);
  }
  const std::size_t kept = next_.size(), leaving = part.size() - kept;
  for (Eigen::Index i = 0; i < gap_m_.size(); ++i) {
    if (gap_m_[i] < -gap_tolerance_m) next_.push_back(i);
  }
  const std::size_t joining = next_.size() - kept;
  solved_ = leaving + joining == 0;
  if (leaving + joining > few) {
    factor_.assign(next_);
    return;
  }
  for (std::size_t k = part.size(); k-- > 0;) {
    if (node_force_n_[part[k]] < 0.0) factor_.remove(static_cast<Eigen::Index>(k));
  }
  for (std::size_t k = kept; k < next_.size(); ++k) factor_.add(next_[k]);
}

void LinearContact::change_worst() {
  const std::vector<Eigen::Index>& part = factor_.part();
  Eigen::Index row = -1, node = -1;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double force_n = node_force_n_[part[k]];
    if (force_n < 0.0 && (row < 0 || force_n < node_force_n_[part[static_cast<std::size_t>(row)]])) {
      row = static_cast<Eigen::Index>(k);
    }
  }
  solved_ = row < 0 && gap_m_.minCoeff(&node) >= -gap_tolerance_m;
  if (row >= 0) {
    factor_.remove(row);
  } else if (!solved_) {
    factor_.add(node);
  }
}

void LinearContact::step(const scene::Pose& pose) {
  find_rest_gaps(pose);
  for (std::size_t k = factor_.part().size(); k-- > 0;) {
    if (!std::isfinite(rest_gap_m_[factor_.part()[k]])) factor_.remove(static_cast<Eigen::Index>(k));
  }
  // All violated nodes change at once, which usually converges in a few iterations. Should the active set cycle, only
  // the most violated node changes.
  const int nodes_at_once = 20, most_rounds = 20 + 4 * nodes();
  solved_ = false;
  for (int round = 0; round < most_rounds && !solved_; ++round) {
    const bool one_only = round >= nodes_at_once;
    solve_touching();
    const std::vector<Eigen::Index>& part = factor_.part();
    node_force_n_.setZero();
    gap_m_ = rest_gap_m_;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const double force_n = part_n_[static_cast<Eigen::Index>(k)];
      node_force_n_[part[k]] = force_n;
      gap_m_ += force_n * compliance_m_per_n_.col(part[k]);
    }
    for (const Eigen::Index i : part) gap_m_[i] = 0.0;

    if (one_only) {
      change_worst();
    } else {
      change_all();
    }
  }
  force_n_.setZero();
  displacement_m_.setZero();
  for (const Eigen::Index i : factor_.part()) {
    force_n_ += node_force_n_[i] * force_on_tool_.col(i);
    displacement_m_ += static_cast<float>(node_force_n_[i]) * displacement_m_per_n_.col(i);
  }
}

Eigen::Matrix3Xd LinearContact::displacement_m() const {
  return displacement_m_.cast<double>().reshaped(3, displacement_m_.size() / 3);
}

std::size_t LinearContact::memory_bytes() const noexcept {
  const auto doubles = nodes_m_.size() + normals_.size() + force_on_tool_.size() + 2 * compliance_m_per_n_.size() +
                       5 * rest_gap_m_.size();
  return sizeof(double) * static_cast<std::size_t>(doubles) +
         sizeof(float) * static_cast<std::size_t>(displacement_m_per_n_.size() + displacement_m_.size());
}

}  // namespace touchstone::compare
