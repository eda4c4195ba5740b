// Contact force of a region, section IV-C.
#pragma once

#include "fast/contact/contact_detection.h"
#include "fast/contact/contact_law.h"

namespace touchstone::fast {

/// Resultant of the points of a region, each F_i = (m_i / m) f(d_i).
struct RegionLoad {
  double force_n = 0.0;                          ///< F = sum F_i
  scene::Vec3 center_T_m = scene::Vec3::Zero();  ///< sum F_i p_i / F about the tool's mass centre, tool frame
  double deepest_m = 0.0;                        ///< largest d_i
};

/// Since the mass weights sum to one, F is a weighted mean of f(d_i) and does not grow with the contact area (errata
/// E7).
/// @param depth_scale every d_i is taken this many times as deep
[[nodiscard]] RegionLoad region_load(const DuffingLaw& law, const RegionPoints& points,
                                     double depth_scale = 1.0) noexcept;

/// Force of the body on the tool, world frame.
struct RegionForce {
  double magnitude_n = 0.0;                         ///< |F_c|
  scene::Vec3 force_n = scene::Vec3::Zero();        ///< F_c = F_cn + F_ct
  scene::Vec3 torque_nm = scene::Vec3::Zero();      ///< of F_c at the centre of pressure, about the tool's mass centre
  double normal_n = 0.0;                            ///< |F_cn|, against d
  scene::Vec3 tangential_n = scene::Vec3::Zero();   ///< F_ct, at right angles to d
  scene::Vec3 load_center_m = scene::Vec3::Zero();  ///< centre of pressure sum F_i p_i / F, about the mass centre
  bool saturated = false;                           ///< a point is past the peak of a softening law
};

/// Force without friction: F along -d (errata E4: one law along d for a region).
/// @param R_WT rotation from tool to world; @param d unit direction of deformation in the world
[[nodiscard]] RegionForce region_force(const DuffingLaw& law, const scene::Mat3& R_WT, const scene::Vec3& d,
                                       const RegionPoints& points) noexcept;

/// Writes F_c and all that follows from it. Both parts act at the centre of pressure: the tangential part is
/// distributed over the points in proportion to the normal one.
/// @param tangential_n at right angles to d
void set_force(const scene::Vec3& d, double normal_n, const scene::Vec3& tangential_n, RegionForce& force) noexcept;

}  // namespace touchstone::fast
