// The elastic body without its contact: nodal forces of a displacement and their tangent, cell by cell, with the
// linear equations that this makes. Contact comes in as constraints on the displacement, and as stiffness of nodes.
#pragma once

#include "reference/contact/state.h"
#include "reference/discretisation/discretisation.h"
#include "reference/fe/element.h"
#include "reference/linear/linear_solver.h"
#include "reference/linear/ranks.h"
#include "scene/model/scene.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace touchstone::reference {

/// Numerical parameters that should not affect the result, as factors on the usual ones.
struct Numerics {
  double contact_parameter = 1.0;  ///< c of the active set
  double numerical_bulk = 1.0;     ///< bulk modulus that an incompressible material has in the tangent
};

/// Unknowns are the nodal displacements' degrees of freedom that neither hang nor are prescribed. Of several ranks the
/// first one creates and uses the body; each has a part of the cells and of the matrix. The first rank computes the
/// tangents of all cells in contact, so that the others need no contact data.
template <int dim>
class ElasticBody : public ranks::Part {
 public:
  using Nodal = typename Discretisation<dim>::Nodal;
  using Pressures = Eigen::Matrix<double, dim + 1, Eigen::Dynamic>;

  ElasticBody(Discretisation<dim> mesh, const scene::Material& material, scene::Kinematics kinematics, int threads,
              const Numerics& numerics);
  ~ElasticBody() override;
  ElasticBody(const ElasticBody&) = delete;
  ElasticBody& operator=(const ElasticBody&) = delete;

  [[nodiscard]] const Discretisation<dim>& mesh() const noexcept { return mesh_; }
  [[nodiscard]] LinearSolver& solver() const noexcept { return *solver_; }
  /// The tangent of the last assembly, this rank's part.
  [[nodiscard]] const SymmetricMatrix& matrix() const noexcept { return matrix_; }
  /// Processor time of tangents and forces, all threads.
  [[nodiscard]] double assembly_s() const noexcept { return assembly_s_; }

  /// Fixes the unknowns. @param prescribed  per degree of freedom; @param contact_nodes  which may be constrained
  void number_unknowns(const std::vector<char>& prescribed, const std::vector<int>& contact_nodes);
  [[nodiscard]] int unknowns() const noexcept { return unknowns_; }
  /// The unknown of a degree of freedom, or -1.
  [[nodiscard]] int unknown(int dof) const { return unknown_[static_cast<std::size_t>(dof)]; }

  /// Dead forces on the nodes from now on.
  void load(Nodal force_n);

  struct Forces {
    Nodal nodal_n;                  ///< internal less dead ones, hanging nodes' passed on to their masters
    double volume_error_rel = 0.0;  ///< largest over cells of |integral psi (J - 1 - p / kappa)| / volume
    bool admissible = true;         ///< no cell turned inside out
  };
  [[nodiscard]] Forces forces(const State<dim>& state) const;
  [[nodiscard]] double volume_change_rel(const State<dim>& state) const;

  /// A degree of freedom as the weighted sum of others and an offset.
  struct Line {
    int dof = 0;
    double offset_m = 0.0;
    std::vector<std::pair<int, double>> terms{};
  };
  /// Constrains the displacement of the next step: by hanging nodes, by what prescribed components move, `step_m`, and
  /// by further lines. Lines may refer to each other, but not in a circle.
  void constrain(const Nodal& step_m, const std::vector<Line>& lines);

  /// A weighted sum of nodal forces, wanted as a row of unknowns: the weight of a degree of freedom in it.
  struct InReaction {
    int row = -1;  ///< number of the sum, -1: in none
    double weight = 0.0;
  };
  /// The tangent on the unknowns, under the constraints.
  /// @param constrained_nodes  by contact; an unknown of theirs that depends on others gets an equation of its own,
  ///                           of `their_stiffness_n_per_m`
  /// @param reactions  per degree of freedom; empty: none
  void assemble(const State<dim>& state, Stiffness stiffness, const std::vector<int>& constrained_nodes,
                double their_stiffness_n_per_m, const std::vector<InReaction>& reactions = {});
  /// Adds the stiffness and the force of one node.
  void add(int node, const Eigen::Matrix<double, dim, dim>& K, const Eigen::Matrix<double, dim, 1>& f_n);
  /// Out-of-balance forces: what the tangent is to be solved for.
  [[nodiscard]] const Eigen::VectorXd& right_n() const noexcept { return right_n_; }
  /// The reactions are value + row x at a solution x.
  struct Reactions {
    std::vector<Eigen::Triplet<double>> row;
    Eigen::VectorXd value_n;
  };
  [[nodiscard]] const Reactions& reactions() const noexcept { return reactions_; }
  /// The change of a degree of freedom as a sum over unknowns. @returns its constant part
  double expand(int dof, const std::function<void(int unknown, double weight)>& add) const;

  /// The displacement of all nodes that a solution stands for.
  [[nodiscard]] Nodal displacement_m(const Eigen::VectorXd& x) const;
  /// What the pressures do with a displacement.
  [[nodiscard]] Pressures pressure_change_pa(const Nodal& du_m) const;

  /// On the other ranks: their part of the work of the first one's methods.
  void follow(Order order) override;

 private:
  /// One thread's part of the matrix and of what goes with it.
  struct Lane {
    std::vector<double> value, right_n, reaction_n;
    std::vector<Eigen::Triplet<double>> reaction_rows;
    CellResult<dim> cell;
  };

  [[nodiscard]] std::unique_ptr<ranks::Lead> make_parts(const scene::Material& material, scene::Kinematics kinematics,
                                                        const Numerics& numerics) const;
  template <class Share>
  auto jointly(Order order, const Share& share) const {
    return lead_ ? lead_->jointly(order, share) : share();
  }
  [[nodiscard]] State<dim> receive_state() const;
  [[nodiscard]] Forces forces_of_share(const State<dim>& state) const;
  void make_pattern(const std::vector<char>& in_contact);
  void assemble_share(const State<dim>& state, Stiffness stiffness, const std::vector<char>& in_contact,
                      const std::vector<InReaction>& reactions);
  void add_reactions(const std::vector<unsigned int>& dofs, const std::vector<InReaction>& reactions, Lane& lane) const;
  [[nodiscard]] Pressures pressure_change_of_share(const Nodal& du_m) const;

  Discretisation<dim> mesh_;
  int threads_;
  Element<dim> element_;
  std::vector<CellGeometry<dim>> geometry_;
  std::unique_ptr<ranks::Lead> lead_;  // on the first of several ranks
  std::vector<int> rank_of_cell_;
  std::vector<int> cells_;                // this rank's, ascending
  std::unique_ptr<LinearSolver> solver_;  // after lead_
  mutable double assembly_s_ = 0.0;

  Nodal dead_n_;                  // no columns without any
  std::vector<char> prescribed_;  // per degree of freedom
  std::vector<char> may_touch_;   // per cell: may be constrained by contact
  std::vector<int> unknown_;      // per degree of freedom: its number or -1
  int unknowns_ = 0;
  SymmetricMatrix matrix_;  // this rank's part; without a pattern before the first assembly
  std::unique_ptr<dealii::AffineConstraints<double>> constraints_;
  std::vector<Lane> lanes_;
  Nodal step_m_;  // of prescribed components
  Eigen::VectorXd right_n_;
  Reactions reactions_;

  // Of the last tangent.
  std::vector<int> tangent_cells_;                                 // this rank's, ascending
  std::vector<typename CellResult<dim>::Coupling> pressure_gain_;  // per tangent cell
  Pressures pressure_offset_pa_;                                   // the same
};

}  // namespace touchstone::reference
