// Friction at the active nodes: which of them slip, where to, and what that adds to the tangent.
#pragma once

#include "reference/contact/active_set.h"
#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"
#include "reference/contact/friction.h"

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// Of the current increment and Newton iteration. See contact_problem.h for the method. Without friction nothing slips
/// or sticks.
template <int dim>
class Slipping {
 public:
  using Nodal = typename Discretisation<dim>::Nodal;
  using Point = typename Discretisation<dim>::Point;

  /// @param model  must outlive it
  explicit Slipping(const ContactModel<dim>& model) : model_(model) {}

  void begin_increment(State<dim>& state);
  /// Which active nodes slip next, and their direction. @param before  active in the last iteration
  /// @returns the largest distance of a sticking node from its place [m]
  double update(State<dim>& state, const std::vector<char>& before, const Nodal& forces_n,
                const ActiveSet<dim>& active_set, int iteration, double force_tolerance, bool& changed);
  /// Regions whose nodes all slip, in one direction, begin to slip as a whole (sliding). @returns whether that changes
  /// the coefficient of a region
  bool begin_sliding(State<dim>& state) const;
  /// Makes the solved state the start of the next increment. A region keeps sliding until nodes with half of its normal
  /// force stick.
  void keep_history(State<dim>& state) const;

  [[nodiscard]] bool sticks(int node) const { return contact_at(node) && !contact_at(node)->slips; }
  /// What sticking nodes still have to move.
  [[nodiscard]] const Nodal& stick_m() const noexcept { return stick_m_; }
  /// What is left out of balance of a node's force along the surface.
  [[nodiscard]] Point out_of_balance_n(int node, const Point& along_n) const;

  [[nodiscard]] bool anything_slips() const noexcept { return slip_rows_ > 0; }
  /// The slipping nodes' normal forces as sums of nodal forces.
  [[nodiscard]] std::vector<typename ElasticBody<dim>::InReaction> normal_forces() const;
  /// The stiffness against slip turning round.
  void add_turning(ElasticBody<dim>& body) const;
  [[nodiscard]] SlipCoupling coupling(const ElasticBody<dim>& body, const ActiveSet<dim>& active_set) const;

 private:
  /// Terms of an active node's friction in the tangent.
  struct Slip {
    Point direction = Point::Zero();  // tau / |tau|
    double turning_n_per_m = 0.0;     // resists slip across it
  };
  /// Friction of a region, of the whole body.
  struct RegionFriction {
    double normal_n = 0.0, slipping_normal_n = 0.0, limit_n = 0.0;
    scene::Vec3 friction_n = scene::Vec3::Zero();
    bool sticks_somewhere = false, slides = false;
  };
  [[nodiscard]] std::vector<RegionFriction> region_frictions(const State<dim>& state) const;
  [[nodiscard]] const NodeContact<dim>* contact_at(int node) const {
    return contact_of_.empty() || contact_of_[node] < 0 ? nullptr : &contacts_[contact_of_[node]];
  }

  const ContactModel<dim>& model_;
  Eigen::Matrix3Xd anchors_m_;  // per node: point of the tool from which its slip is measured; NaN: none yet
  std::vector<NodeContact<dim>> contacts_;
  std::vector<Slip> slips_;      // per contact
  std::vector<int> contact_of_;  // per node: index into contacts_, or -1
  std::vector<int> slip_row_;    // per node: row of SlipCoupling, or -1
  int slip_rows_ = 0;
  std::vector<double> slip_stiffness_n_per_m_;  // per node: k_n of tau
  Nodal slip_direction_;                        // tau / |tau| of the last iteration; zero where nothing slipped
  Nodal stick_m_;
};

}  // namespace touchstone::reference
