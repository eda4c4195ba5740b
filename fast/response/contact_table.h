// The force law of a tool's tip on the body near it: the contact problem of a rigid axisymmetric profile on a linear
// half space, in closed form up to integrals (I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47-57), tabulated at set-up.
//
// With the gap g(r) of the undeformed surfaces, the contact's radius a, and t from 0 to a,
//   D(t) = t int_0^t g'(r) / sqrt(t^2 - r^2) dr,   F = 2 E* int_0^a (D(a) - D(t)) dt.
// g is that of the tool's true surface and of the body's own, not of their paraboloids. F is what a line of sources
// from -ia to ia on the axis carries, D(a) - D(|t|) per length; its second moment is the load's.
//
// A capsule on its side is no such profile: its table is computed with line_contact.h.
#pragma once

#include "fast/response/finite_strain.h"
#include "scene/model/scene.h"
#include "scene/response/tool_tip.h"

#include <cstddef>
#include <vector>

namespace touchstone::fast {

/// The body's surface below its tangent plane at a point, a mean over the directions: h(r) = h2 r^2 + h4 r^4.
struct LocalShape {
  double h2_per_m = 0.0, h4_per_m3 = 0.0;
  [[nodiscard]] double height_m(double r_m) const noexcept { return r_m * r_m * (h2_per_m + h4_per_m3 * r_m * r_m); }
  [[nodiscard]] double slope(double r_m) const noexcept { return r_m * (2.0 * h2_per_m + 4.0 * h4_per_m3 * r_m * r_m); }
  [[nodiscard]] double curvature_per_m() const noexcept { return 2.0 * h2_per_m; }
};

/// @param point_m, normal  of the surface; @param reach_m  up to which radius it is wanted; less where the face ends
[[nodiscard]] LocalShape local_shape(const scene::Shape& body, const scene::Vec3& point_m, const scene::Vec3& normal,
                                     double reach_m);

/// A contact at one local indentation.
struct LocalContact {
  double force_n = 0.0;
  double stiffness_n_per_m = 0.0;       ///< dF / d(indentation)
  double radius_m = 0.0;                ///< a; half the width of a line's contact
  double flat = 0.0;                    ///< pressure between a ball's (0) and a flat punch's (1), by its second moment
  double widening = 1.0, peaked = 0.0;  ///< of the pressure, as of SpreadLoad
  /// Of a line: radius and half the length of a ball's pressure that is swept along a line and has the second moments
  /// of this one.
  double patch_radius_m = 0.0, half_line_m = 0.0;
};

class ContactTable {
 public:
  /// @param local      not used for a line, which lies on a plane
  /// @param E_star_pa  E / (1 - nu^2)
  ContactTable(const scene::ToolTip& tip, const LocalShape& local, double E_star_pa, const FiniteStrain& strain);

  /// At a local indentation [m], which is held at the largest of the table.
  [[nodiscard]] LocalContact at(double indentation_m) const noexcept;

  /// int_0^indentation F [J].
  [[nodiscard]] double energy_j(double indentation_m) const noexcept;

  /// Pressure on the half space per newton of the contact's force, under a disc or a line [1/m^2]; not kept for a ball.
  /// With D(t) as above, p = E*/pi int_r^a D'(t) / sqrt(t^2 - r^2) dt under a disc.
  /// @param across_m  from the disc's axis, from the line; @param along_m  the line from its middle; 0 for a disc
  [[nodiscard]] double pressure_per_m2(double indentation_m, double across_m, double along_m) const noexcept;
  /// The largest of the contact.
  [[nodiscard]] double largest_pressure_per_m2(double indentation_m) const noexcept;

  [[nodiscard]] double largest_indentation_m() const noexcept { return largest_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return nodes_.size() * sizeof(Node) + rim_.size() * sizeof(Rim) + pressure_rel_.size() * sizeof(float);
  }

 private:
  /// At even steps of s = sqrt(indentation), in which force and radius are smooth.
  struct Node {
    double force_n = 0.0, slope = 0.0;  ///< dF / ds
    double radius_m = 0.0, flat = 0.0, widening = 1.0, peaked = 0.0;
    double energy_j = 0.0;
    double patch_radius_m = 0.0, half_line_m = 0.0;
  };
  void tabulate_line(const scene::ToolTip& tip, double E_star_pa, const FiniteStrain& strain);
  struct Place {
    std::size_t node;
    double share;  ///< of the way to the next
  };
  [[nodiscard]] Place place(double s) const noexcept;
  /// Up to share t of the way from node i to the next.
  [[nodiscard]] double energy_j(std::size_t i, double t) const noexcept;

  [[nodiscard]] double disc_pressure_per_m2(double indentation_m, double r_m) const noexcept;

  /// D(t) from the edge of a disc's flat part on, in straight lines.
  struct Rim {
    double t_m, D_m;
  };

  std::vector<Node> nodes_;
  std::vector<Rim> rim_;                  ///< of a disc
  std::vector<float> pressure_rel_;       ///< of a line: LineContact's at all nodes but the first
  double radius_m_ = 0.0, line_m_ = 0.0;  ///< of a line: its ball's, and half its length
  double step_ = 0.0;                     ///< of s
  double largest_m_ = 0.0;
};

}  // namespace touchstone::fast
