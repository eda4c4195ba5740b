// What a scene is: one elastic body, one rigid tool, its track, the contact law, and each solver's
// own settings. Both solvers take the same object. Every key, unit, range and default: scene_fields.cc.
#pragma once

#include "scene/frames.h"
#include "scene/shape.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::scene {

enum class BodyShape { box, sphere };
enum class ToolShape { sphere };
enum class Support { bottom };
enum class ContactLaw { duffing };
enum class Formulation { published, corrected };
enum class Kinematics { finite, small };

/// Isotropic elastic material.
struct Material {
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;  ///< 0 to 0.5; exactly 0.5 is incompressible

  [[nodiscard]] double shear_modulus_pa() const noexcept { return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio)); }
  /// Infinite at poissons_ratio = 0.5.
  [[nodiscard]] double bulk_modulus_pa() const noexcept {
    return youngs_modulus_pa / (3.0 * (1.0 - 2.0 * poissons_ratio));
  }
  /// E / (1 - nu^2), the modulus of contact with a rigid tool [Pa].
  [[nodiscard]] double contact_modulus_pa() const noexcept {
    return youngs_modulus_pa / (1.0 - poissons_ratio * poissons_ratio);
  }
};

struct Body {
  BodyShape shape = BodyShape::box;
  Vec3 size_m = Vec3::Zero();  ///< box only: edge lengths
  double radius_m = 0.0;       ///< sphere only
  Support support = Support::bottom;
  double support_height_m = 0.0;  ///< sphere only: surface below this height is held
  Material material;
};

struct Tool {
  ToolShape shape = ToolShape::sphere;
  double radius_m = 0.0;
  double mass_kg = 0.0;
};

/// The tool's pose at one time; between two of them position is linear and orientation slerp.
struct Waypoint {
  double time_s = 0.0;
  Pose pose;
};

/// Duffing contact force in identifiable constants: F = k1 D + k3 D^3, where k1 = m w0^2 and
/// k3 = (3/4) m b0^2 eps keeps the paper's 3/4 inside (errata E1).
struct Contact {
  ContactLaw law = ContactLaw::duffing;
  double k1_n_per_m = 0.0;
  double k3_n_per_m3 = 0.0;
};

/// Settings of the real-time model; names are the paper's symbols.
struct FastSettings {
  Formulation formulation = Formulation::corrected;
  int triangles = 0;     ///< body surface, also the rest points of every comparison
  int tool_samples = 0;  ///< points on the tool's surface
  double rate_hz = 0.0;  ///< ticks per second of virtual time
  double r_th_m = 0.0;   ///< contact points closer than this are one region
  double r_R_m = 0.0;    ///< radius of the local neighbourhood R
  double C_n = 0.0;      ///< local factor, strength
  double C_r_m = 0.0;    ///< local factor, core radius
  double s_c_m2 = 0.0;   ///< total beam cross-section, (19)
};

struct ReferenceSettings {
  Kinematics kinematics = Kinematics::finite;
  int levels = 0;                        ///< systematically refined meshes, at least 3 for an uncertainty
  std::optional<double> element_size_m;  ///< cells under the tool on the coarsest level; automatic when absent
};

struct CompareSettings {
  int instants = 0;  ///< evenly spaced track instants recorded by both sides, first and last included
};

struct Scene {
  std::string name;  ///< file stem; names the output folder
  std::string title;
  Body body;
  Tool tool;
  std::vector<Waypoint> track;  ///< at least two, times strictly increasing
  Contact contact;
  FastSettings fast;
  ReferenceSettings reference;
  CompareSettings compare;
};

/// The body's rest surface in the world frame, its lowest point on z = 0 and its centre on the z axis.
[[nodiscard]] std::unique_ptr<const Shape> body_shape(const Body& body);

/// The tool's surface in the tool frame.
[[nodiscard]] std::unique_ptr<const Shape> tool_shape(const Tool& tool);

/// The tool's pose at a time; held at the ends outside the track.
[[nodiscard]] Pose pose_at(const std::vector<Waypoint>& track, double time_s);

/// The instants at which both sides record: compare.instants times, evenly spaced over the track [s].
[[nodiscard]] std::vector<double> instants_s(const Scene& scene);

/// How far the tool reaches below the rest surface [m]: the largest -signed_distance over the tool;
/// zero when apart. The one depth both sides quote.
[[nodiscard]] double rest_depth_m(const Shape& body, const Tool& tool, const Pose& pose);

}  // namespace touchstone::scene
