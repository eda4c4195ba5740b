// What a scene is: one elastic body, one rigid tool, its track, the contact law, and each solver's
// own settings. Both solvers take the same object. Every key, unit, range and default: scene/input/fields.cc.
#pragma once

#include "scene/base/frames.h"
#include "scene/mesh/triangle_mesh.h"
#include "scene/shape/solids.h"
#include "scene/shape/surface.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

enum class BodyShape { box, sphere, ellipsoid, revolution };
enum class ToolShape { sphere, capsule, cylinder, box, mesh };
enum class LengthUnit { m, cm, mm, inch };
enum class Support { bottom };
enum class ContactLaw { duffing, area_aware };
struct LawName {
  std::string_view word;   ///< in scene files
  std::string_view title;  ///< in texts
};
/// In the order of the enumeration.
inline constexpr LawName contact_law_names[] = {{"duffing", "Duffing"}, {"area_aware", "area-aware"}};
[[nodiscard]] constexpr const LawName& name_of(ContactLaw law) { return contact_law_names[static_cast<int>(law)]; }
/// The paper's method as printed, its corrected form, or the response model.
enum class Formulation { published, corrected, response };
inline constexpr std::string_view formulation_words[] = {"published", "corrected", "response"};
[[nodiscard]] constexpr std::string_view name_of(Formulation f) { return formulation_words[static_cast<int>(f)]; }
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

/// A convex solid; its shape determines which members are used.
struct Solid {
  BodyShape shape = BodyShape::box;
  Vec3 size_m = Vec3::Zero();       ///< box: edge lengths
  double radius_m = 0.0;            ///< sphere, cylinder
  double length_m = 0.0;            ///< cylinder
  Vec3 semi_axes_m = Vec3::Zero();  ///< ellipsoid: along x, y, z
  Profile profile;                  ///< revolution: about z
  std::string_view named = {};      ///< revolution: the SolidKind that its profile follows from; empty: it is given
};

/// Computes the profile of a solid with a name from its lengths.
void complete(Solid& solid);

inline constexpr std::size_t inclusions_max = 16;

/// A part of the body of another material, strictly inside it, apart from the other inclusions.
struct Inclusion : Solid {
  Vec3 center_m = Vec3::Zero();  ///< of its bounding box, world frame at rest
  Material material;
};

struct Body : Solid {
  Support support = Support::bottom;
  double support_height_m = 0.0;  ///< a body without a flat bottom: surface below this height is held
  Material material;
  std::vector<Inclusion> inclusions;  ///< empty: homogeneous

  /// The bottom is a face, and all of it is held.
  [[nodiscard]] bool flat_bottom() const noexcept;
};

/// The rigid tool. Capsule and cylinder lie along z of the tool, box edges along its axes.
struct Tool {
  ToolShape shape = ToolShape::sphere;
  double radius_m = 0.0;  ///< sphere, capsule, cylinder
  double mass_kg = 0.0;
  double length_m = 0.0;                     ///< capsule: of the straight part; cylinder: overall
  double edge_radius_m = 0.0;                ///< cylinder: of the fillet at both rims
  Vec3 size_m = Vec3::Zero();                ///< box: edge lengths
  std::string file;                          ///< mesh: path relative to the scene file
  LengthUnit unit = LengthUnit::m;           ///< mesh: of the file's coordinates
  std::shared_ptr<const TriangleMesh> mesh;  ///< mesh: as read, in metres, before the mass centre is taken off
  /// Mass centre, from the shape's centre or in the mesh's own coordinates; absent: the centre of a uniform solid.
  std::optional<Vec3> mass_center_m;

  /// Convex and in one piece: it has one contact region on a convex body. For a mesh: TriangleMesh::convex.
  [[nodiscard]] bool convex() const noexcept { return shape != ToolShape::mesh || (mesh && mesh->convex); }
};

/// The tool's pose at one time; between two of them position is linear and orientation slerp.
struct Waypoint {
  double time_s = 0.0;
  Pose pose;
};

/// Friction limits of the contact (section IV-B): sticking up to f_max = K F_n^beta, slipping at mu_D F_n.
struct Friction {
  double K = 0.0;                ///< [N^(1 - beta)]
  double beta = 0.0;             ///< 2/3 to 1
  double mu_D = 0.0;             ///< dynamic friction coefficient
  double stiffness_ratio = 1.0;  ///< kappa = (F_t / D_t) / (F_n / D_n) of the sticking contact; corrected formulation
  bool operator==(const Friction&) const = default;
};

/// Contact force law in identifiable constants: F = k1 D + k3 D^3, where k1 = m w0^2 and k3 = (3/4) m b0^2 eps keeps
/// the paper's 3/4 inside (errata E1). The area-aware law (errata E7) takes k1 = k1_per_radius a, a = sqrt(A / pi).
struct Contact {
  ContactLaw law = ContactLaw::duffing;
  double k1_n_per_m = 0.0;  ///< duffing
  double k3_n_per_m3 = 0.0;
  double k1_per_radius_n_per_m2 = 0.0;    ///< area_aware
  double r_th_m = 0.0;                    ///< contact points closer than this are one region, for both solvers
  std::optional<Friction> friction = {};  ///< absent: frictionless
  bool operator==(const Contact&) const = default;
};

/// Settings of the real-time model; names are the paper's symbols.
struct FastSettings {
  Formulation formulation = Formulation::corrected;
  int triangles = 0;                ///< body surface, also the rest points of every comparison
  int tool_samples = 0;             ///< points on the tool's surface
  double rate_hz = 0.0;             ///< ticks per second of virtual time
  int max_regions = 1;              ///< contact regions at a time; a convex tool needs one
  double r_R_m = 0.0;               ///< radius of the local neighbourhood R
  double C_n = 0.0;                 ///< local factor, strength
  double C_r_m = 0.0;               ///< local factor, core radius
  double s_c_m2 = 0.0;              ///< total beam cross-section, (19)
  double body_falloff_per_m = 0.0;  ///< of the response model's body compliance; only with inclusions
  /// Folder of results; the response model reads its file there. Not a key: where a program runs decides.
  std::filesystem::path store = "out/reference-store";
};

struct ReferenceSettings {
  Kinematics kinematics = Kinematics::finite;
  double error = 0.01;                   ///< refine until the uncertainty of force and shape is this
  std::optional<int> levels;             ///< in place of `error`: number of meshes, at least 3 for an uncertainty
  std::optional<double> element_size_m;  ///< cells under the tool on the coarsest level; automatic when absent
  /// Share of a level's cells that the next one divides, where the error is estimated to be; absent: the fixed family
  std::optional<double> adaptive_share;
};

struct CompareSettings {
  int instants = 0;  ///< evenly spaced track instants recorded by both solvers, first and last included
};

/// Limits of the device loop, and the virtual hand that can take the place of a device.
struct LiveSettings {
  double force_max_n = 0.0;             ///< norm of the force sent to the device
  double force_slew_n_per_s = 0.0;      ///< change of that force
  double release_s = 0.0;               ///< after a bad pose the force falls to zero in this time
  double hand_mass_kg = 0.0;            ///< the hand's mass with the device's
  double hand_damping_n_s_per_m = 0.0;  ///< between hand and track
  double hand_stiffness_n_per_m = 0.0;  ///< between hand and track
};

inline constexpr std::size_t probes_max = 1000;

/// A point of the body at which the reference reports displacement, stress and pressure.
struct Probe {
  std::string name;
  Vec3 position_m = Vec3::Zero();  ///< in the body or on its surface, world frame at rest
};

struct Scene {
  std::string name;  ///< file stem; names the output folder
  std::string title;
  Body body;
  Tool tool;
  std::vector<Waypoint> track;  ///< at least two, times strictly increasing
  std::vector<Probe> probes;    ///< of different names
  Contact contact;
  FastSettings fast;
  LiveSettings live;
  ReferenceSettings reference;
  CompareSettings compare;
};

/// The solid's surface, the centre of its bounding box at center_m.
[[nodiscard]] std::unique_ptr<const Shape> solid_shape(const Solid& solid, const Vec3& center_m);

/// The body's rest surface in the world frame, its lowest point on z = 0 and its centre on the z axis.
[[nodiscard]] std::unique_ptr<const Shape> body_shape(const Body& body);

/// A convex tool's surface in the tool frame, whose origin is the mass centre; null for a mesh.
[[nodiscard]] std::unique_ptr<const Shape> tool_shape(const Tool& tool);

/// A mesh tool's surface in the tool frame.
[[nodiscard]] TriangleMesh tool_mesh(const Tool& tool);

/// The tool's pose at a time; held at the ends outside the track.
[[nodiscard]] Pose pose_at(const std::vector<Waypoint>& track, double time_s);

/// The instants at which both solvers record: compare.instants times, evenly spaced over the track [s].
[[nodiscard]] std::vector<double> instants_s(const Scene& scene);

/// How far the tool reaches below the rest surface [m]: the largest -signed_distance over the tool, to 1e-7 of the
/// body's size; zero when apart. A ball counts from its centre, and a capsule from its axis: the radius minus the
/// signed distance there, which is the shortest displacement that separates them. It differs from the former only
/// across an edge of the body, where it is measured along the diagonal. For a mesh only the surface is used, not the
/// space inside. Both solvers report this depth.
/// Not for a real-time step: 2 to 80 us, for a mesh of 6000 triangles up to 3 ms.
[[nodiscard]] double rest_depth_m(const Shape& body, const Tool& tool, const Pose& pose);

/// Edge of the cube that holds as much as the body's bounding box [m]: default lengths are fractions of it.
[[nodiscard]] double body_size_m(const Body& body);

/// Any tool's surface in the tool frame. @param triangles requested number; a mesh tool keeps its own
[[nodiscard]] Surface tool_surface(const Tool& tool, int triangles);

}  // namespace touchstone::scene
