// Friction of a contact that partly sticks: springs beside each other, which slip one by one.
//
// Shear the contact of the force law F(D) by u. Where it sticks is a contact of the same law, and the shear force is
//   Q = mu (F(D) - F(D - G* u / (mu E*))),   G* / E* = 2 (1 - nu) / (2 - nu)
// (J. Jaeger, Arch. Appl. Mech. 65 (1995) 478-487; M. Ciavarella, J. Appl. Mech. 65 (1998) 998-1003); Cattaneo's and
// Mindlin's under a ball. Springs from depth g on, of stiffness F''(g) dg, press with F''(g) (D - g) dg, together with
// F(D). Sheared with G* / E* of that stiffness and held by mu times their pressing force, together they give Q, and
// they remember every turning point (V. L. Popov & M. Hess, Method of Dimensionality Reduction in Contact Mechanics
// and Friction (2015), ch. 5). Each slips against its own force, whatever the direction: the contact dissipates.
#pragma once

#include "fast/response/contact_table.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace touchstone::fast {

/// The constant part.
class SlipSprings {
 public:
  /// @param table  whose distribution of F'' over the depth stands for every place
  SlipSprings(const scene::Friction& friction, double poissons_ratio, const ContactTable& table);

  static constexpr int count = 128;  ///< at even steps of the square root of the depth
  struct End {
    double depth_m, force_n, stiffness_n_per_m;
    double radius_m;  ///< a there
  };
  /// From springs' first depths to their last, count + 1; the first is at no depth and without stiffness, so that the
  /// first spring has all of a flat punch's.
  [[nodiscard]] const std::vector<End>& ends() const noexcept { return ends_; }
  [[nodiscard]] const ContactTable& table() const noexcept { return table_; }

  /// Of a contact that slips as a whole, and of one that does not.
  [[nodiscard]] double coefficient(double normal_n, bool sliding) const noexcept;
  [[nodiscard]] double shear_ratio() const noexcept { return shear_ratio_; }  ///< G* / E*
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return table_.memory_bytes() + ends_.size() * sizeof(End); }

 private:
  scene::Friction friction_;
  double shear_ratio_;
  ContactTable table_;
  std::vector<End> ends_;
};

/// What friction keeps from tick to tick; the initial value is that of a new contact. Lengths and forces are in a
/// tangent frame that is carried along with the surface's normal.
struct SlipState {
  std::array<double, SlipSprings::count> x_n{}, y_n{};         ///< on the body
  std::array<double, SlipSprings::count> stiffness_n_per_m{};  ///< of shear; 0 for springs that do not touch
  int touching = 0;                                            ///< the first ones
  Eigen::Matrix<double, 3, 2> frame = Eigen::Matrix<double, 3, 2>::Zero();  ///< world; zero before the first tick
  Eigen::Vector2d last_n = Eigen::Vector2d::Zero();                         ///< their sum
  Eigen::Vector2d body_m = Eigen::Vector2d::Zero();                         ///< by which the body gives way sideways
  scene::Pose before;                                                       ///< of the last tick
  bool sliding = false;                                                     ///< all springs slip

  /// On the body, world; of the last tick.
  [[nodiscard]] scene::Vec3 force_n() const noexcept { return frame * last_n; }
  /// Turns the frame to this tick's normal. @returns whether there is a last tick
  bool carry(const scene::Vec3& normal) noexcept;
};

/// What a tick's springs do together, in the state's frame.
struct Slip {
  Eigen::Vector2d force_n = Eigen::Vector2d::Zero();         ///< Q, on the body
  Eigen::Vector2d moment_n_m2 = Eigen::Vector2d::Zero();     ///< second moment of its sources, as of SpreadLoad's
  Eigen::Vector2d displacement_m = Eigen::Vector2d::Zero();  ///< of the contact's middle on the half space
};

/// One tick: moves the contact over the body's surface.
/// @param law               of the tick, at this indentation [m]
/// @param compliance_m_per_n  of the body beyond the half space, sideways
/// @param sway_m            by which the normal force moves the body sideways
/// @param step_m            of the tool's material point at the contact since the last tick
Slip slip(const SlipSprings& springs, const LocalContact& law, double indentation_m,
          const Eigen::Matrix2d& compliance_m_per_n, const Eigen::Vector2d& sway_m, const Eigen::Vector2d& step_m,
          SlipState& state) noexcept;

}  // namespace touchstone::fast
