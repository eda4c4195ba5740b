// The elastic body alone: forces, tangent and constraints, without a tool.
#include "reference/contact/elastic_body.h"

#include "reference/linear/linear_solver.h"
#include "reference/mesh/mesh.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>

namespace touchstone::reference {
namespace {

/// A block with hanging nodes, held below.
Discretisation<3> graded_block() {
  BlockSpec spec;
  spec.lower_m = {-0.01, -0.01, 0.0};
  spec.upper_m = {0.01, 0.01, 0.02};
  spec.grading.discs.push_back({{0.0, 0.0, 0.02}, {0.0, 0.0, 1.0}, 0.001, 0.005});
  spec.grading.largest_m = 0.01;
  spec.grading.growth = 1.5;
  return block_mesh(spec);
}

class ElasticBodyTest : public testing::Test {
 protected:
  ElasticBodyTest() : body_(graded_block(), {3e6, 0.4}, scene::Kinematics::finite, 2, {}) {
    const Discretisation<3>& mesh = body_.mesh();
    EXPECT_GT(mesh.hanging_count(), 0);
    prescribed_.assign(static_cast<std::size_t>(3 * mesh.node_count()), 0);
    for (const auto& face : mesh.faces) {
      if (face.boundary != Boundary::held) continue;
      for (const int node : face.nodes) {
        for (int i = 0; i < 3; ++i) prescribed_[static_cast<std::size_t>(3 * node + i)] = 1;
      }
    }
    body_.number_unknowns(prescribed_, {});
    still_m_ = Eigen::Matrix3Xd::Zero(3, mesh.node_count());
    state_.u_m = still_m_;
    for (int k = 0; k < state_.u_m.size(); ++k) {
      if (!prescribed_[static_cast<std::size_t>(k)]) state_.u_m.data()[k] = 2e-4 * std::sin(0.7 * k);
    }
    mesh.distribute(state_.u_m);
    state_.p_pa = Eigen::Matrix4Xd::Constant(4, mesh.cell_count(), 1e3);
  }

  /// The matrix of the last assembly in full.
  [[nodiscard]] Eigen::MatrixXd matrix() const {
    const SymmetricMatrix& K = body_.matrix();
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(body_.unknowns(), body_.unknowns());
    for (std::int64_t c = 0; c < K.size(); ++c) {
      for (std::int64_t k = K.column_begin[c]; k < K.column_begin[c + 1]; ++k) {
        full(K.row[k], c) = full(c, K.row[k]) = K.value[k];
      }
    }
    return full;
  }
  [[nodiscard]] Eigen::VectorXd on_unknowns(const Eigen::Matrix3Xd& values) const {
    Eigen::VectorXd result(body_.unknowns());
    for (int dof = 0; dof < values.size(); ++dof) {
      if (body_.unknown(dof) >= 0) result[body_.unknown(dof)] = values.data()[dof];
    }
    return result;
  }

  ElasticBody<3> body_;
  std::vector<char> prescribed_;
  Eigen::Matrix3Xd still_m_;
  State<3> state_;
};

TEST_F(ElasticBodyTest, TangentIsTheSlopeOfTheForces) {
  body_.constrain(still_m_, {});
  body_.assemble(state_, Stiffness::consistent, {}, 1.0);
  const Eigen::MatrixXd K = matrix();
  const double step_m = 1e-9;
  for (int unknown = 5; unknown < body_.unknowns(); unknown += 97) {
    const Eigen::Matrix3Xd du_m = body_.displacement_m(Eigen::VectorXd::Unit(body_.unknowns(), unknown));
    // Along a displacement the pressures follow, but for what they are out of balance by.
    const Eigen::Matrix4Xd dp_pa = body_.pressure_change_pa(du_m) - body_.pressure_change_pa(still_m_);
    State<3> up = state_, down = state_;
    up.u_m += step_m * du_m;
    down.u_m -= step_m * du_m;
    up.p_pa += step_m * dp_pa;
    down.p_pa -= step_m * dp_pa;
    const Eigen::VectorXd slope =
        (on_unknowns(body_.forces(up).nodal_n) - on_unknowns(body_.forces(down).nodal_n)) / (2.0 * step_m);
    EXPECT_LT((K.col(unknown) - slope).norm(), 1e-5 * K.col(unknown).norm()) << unknown;
  }
}

/// A line that ties one degree of freedom to others is what multiplying by its matrix from both sides gives; sums of
/// forces go along.
TEST_F(ElasticBodyTest, LinesConstrainTheTangentAndTheReactions) {
  body_.constrain(still_m_, {});
  body_.assemble(state_, Stiffness::consistent, {}, 1.0);
  const Eigen::MatrixXd K = matrix();
  const Eigen::VectorXd right_n = body_.right_n();

  int node = 0;  // on the top, a master of hanging nodes or next to one
  const Discretisation<3>& mesh = body_.mesh();
  while (mesh.hangs(node) || mesh.points_m(2, node) < 0.02) ++node;
  const int x = body_.unknown(3 * node), z = body_.unknown(3 * node + 2);
  const double weight = 0.3, offset_m = 2e-5;
  std::vector<ElasticBody<3>::InReaction> reactions(prescribed_.size());
  reactions[static_cast<std::size_t>(3 * node + 2)] = {0, 2.0};
  body_.constrain(still_m_, {{3 * node + 2, offset_m, {{3 * node, weight}}}});
  body_.assemble(state_, Stiffness::consistent, {node}, 7.0, reactions);

  Eigen::MatrixXd wanted = K;
  wanted.col(x) += weight * wanted.col(z);
  wanted.row(x) += weight * wanted.row(z);
  wanted.col(z).setZero();
  wanted.row(z).setZero();
  wanted(z, z) = 7.0;
  EXPECT_LT((matrix() - wanted).norm(), 1e-13 * K.norm());
  Eigen::VectorXd wanted_n = right_n - offset_m * K.col(z);
  wanted_n[x] += weight * wanted_n[z];
  wanted_n[z] = 0.0;
  EXPECT_LT((body_.right_n() - wanted_n).norm(), 1e-12 * wanted_n.norm());

  Eigen::VectorXd solution = Eigen::VectorXd::Zero(body_.unknowns());
  solution[x] = 1e-4;
  const Eigen::Matrix3Xd du_m = body_.displacement_m(solution);
  EXPECT_NEAR(du_m(2, node), weight * 1e-4 + offset_m, 1e-18);
  double reaction_n = body_.reactions().value_n[0];
  for (const auto& entry : body_.reactions().row) reaction_n += entry.value() * solution[entry.col()];
  const double expected_n = 2.0 * (K.row(z).dot(on_unknowns(du_m)) - right_n[z]);
  EXPECT_NEAR(reaction_n, expected_n, 1e-10 * std::abs(expected_n));
}

TEST_F(ElasticBodyTest, NumbersNeitherHangingNorPrescribedNodes) {
  int free = 0;
  for (int dof = 0; dof < 3 * body_.mesh().node_count(); ++dof) {
    const bool hangs = body_.mesh().hangs(dof / 3);
    EXPECT_EQ(body_.unknown(dof) < 0, hangs || prescribed_[static_cast<std::size_t>(dof)] != 0);
    free += body_.unknown(dof) >= 0 ? 1 : 0;
  }
  EXPECT_EQ(free, body_.unknowns());
}

}  // namespace
}  // namespace touchstone::reference
