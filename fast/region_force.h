// Contact force of a region, section IV-C.
#pragma once

#include "fast/contact_detection.h"
#include "fast/contact_law.h"

namespace touchstone::fast {

/// Force of the body on the tool, world frame.
struct RegionForce {
  double magnitude_n = 0.0;                     ///< F
  scene::Vec3 force_n = scene::Vec3::Zero();    ///< F against d
  scene::Vec3 torque_nm = scene::Vec3::Zero();  ///< about the tool's mass centre
  bool saturated = false;                       ///< a point is past the peak of a softening law
};

/// F = sum F_i, F_i = (m_i / m) f(d_i), each along -d at its point p_i (errata E4: one law along d for a region).
/// Since the shares sum to one, F is a weighted mean of f(d_i) and does not grow with the contact area (errata E7).
/// @param R_WT rotation from tool to world; @param d unit direction of deformation in the world
[[nodiscard]] RegionForce region_force(const DuffingLaw& law, const scene::Mat3& R_WT, const scene::Vec3& d,
                                       const RegionPoints& points) noexcept;

}  // namespace touchstone::fast
