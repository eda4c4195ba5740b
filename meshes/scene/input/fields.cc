#include "scene/input/fields.h"

#include "scene/base/index.h"
#include "scene/base/text.h"
#include "scene/model/solid_kinds.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <list>

namespace touchstone::scene {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Range between(double low, double high) { return {low, high, false, false}; }
Range above(double low, double high = inf) { return {low, high, true, high == inf}; }

template <class Enum, class T = Scene>
Choice<T> choice(std::vector<std::string_view> names, Enum& (*member)(T&)) {
  return {std::move(names), [member](const T& object) { return static_cast<int>(member(const_cast<T&>(object))); },
          [member](T& object, int value) { member(object) = static_cast<Enum>(value); }};
}

// One key per row is easier to read.
// clang-format off

template <class T, Solid& (*solid)(T&)>
Choice<T> solid_choice() {
  Choice<T> out{{},
                [](const T& t) { return static_cast<int>(&kind_of(solid(const_cast<T&>(t))) - solid_kinds().data()); },
                [](T& t, int value) {
                  const SolidKind& kind = nth(solid_kinds(), value);
                  solid(t).shape = kind.shape;
                  solid(t).named = kind.named() ? kind.word : std::string_view();
                }};
  for (const SolidKind& kind : solid_kinds()) out.names.push_back(kind.word);
  return out;
}

template <auto member>
struct Of {};

/// The keys of a convex solid's lengths, each valid for the shapes that use it.
/// @param table  prefix of the keys
template <class T, Solid& (*solid)(T&)>
std::vector<Field<T>> solid_fields(const std::string& table) {
  static std::list<std::string> texts;  // of keys and conditions
  const auto key = [&](std::string_view name) -> std::string_view { return texts.emplace_back(table).append(name); };
  const std::string_view shape = key("shape");
  const auto only = [&]<auto length>(Of<length>) {
    std::string words;
    for (const SolidKind& kind : solid_kinds()) {
      if (kind.uses(length)) words += (words.empty() ? "" : " or ") + toml_quoted(kind.word);
    }
    return Condition<T>{shape, key("shape = " + words), [](const T& t) { return kind_of(solid(const_cast<T&>(t))).uses(length); }};
  };
  return {
      {shape, "", Range{}, {}, Side::both, solid_choice<T, solid>(), {},
           "Shape of the elastic solid, convex; a body's lowest point is on z = 0, its centre on the z axis."},
      {key("size_m"), "m", between(1e-4, 10.0), {}, Side::both, +[](T& t) -> Vec3& { return solid(t).size_m; }, only(Of<&Solid::size_m>()),
           "Edge lengths of the box along x, y, z."},
      {key("radius_m"), "m", between(1e-4, 10.0), {}, Side::both, +[](T& t) -> double& { return solid(t).radius_m; }, only(Of<&Solid::radius_m>()),
           "Radius of the sphere or cylinder."},
      {key("length_m"), "m", between(1e-4, 10.0), {}, Side::both, +[](T& t) -> double& { return solid(t).length_m; }, only(Of<&Solid::length_m>()),
           "Length of the cylinder along z, from end to end."},
      {key("semi_axes_m"), "m", between(1e-4, 10.0), {}, Side::both, +[](T& t) -> Vec3& { return solid(t).semi_axes_m; }, only(Of<&Solid::semi_axes_m>()),
           "Semi-axes of the ellipsoid along x, y, z."},
      {key("profile_rz_m"), "m", between(-10.0, 10.0), {}, Side::both, +[](T& t) -> std::vector<Eigen::Vector2d>& { return solid(t).profile.rz_m; }, only(Of<&Solid::profile>()),
           "Corners [r, z] of the profile, from its lowest point on the axis up to its highest; r = 0 at both."},
      {key("profile_arc_radius_m"), "m", between(0.0, 100.0), "[]", Side::both, +[](T& t) -> std::vector<double>& { return solid(t).profile.arc_radius_m; }, only(Of<&Solid::profile>()),
           "For each piece between two corners the radius of an arc that bulges outwards, 0 for a straight piece; empty: all straight."},
  };
}

/// Three digits are accurate enough for a default and easier to read.
double three_digits(double value) { return rounded(value, 3); }

std::vector<std::string_view> law_words() {
  std::vector<std::string_view> words;
  for (const LawName& law : contact_law_names) words.push_back(law.word);
  return words;
}

Solid& solid_of(Scene& scene) { return scene.body; }
Solid& solid_of(Inclusion& inclusion) { return inclusion; }

std::vector<Field<Scene>> make_scene_fields() {
  using S = Scene;
  const std::optional<Condition<S>> always,
      body_round = Condition<S>{"body.shape", "a body without a flat bottom", [](const S& s) { return !s.body.flat_bottom(); }},
      tool_round = Condition<S>{"tool.shape", "tool.shape = \"sphere\", \"capsule\" or \"cylinder\"", [](const S& s) { return s.tool.shape == ToolShape::sphere || s.tool.shape == ToolShape::capsule || s.tool.shape == ToolShape::cylinder; }},
      tool_long = Condition<S>{"tool.shape", "tool.shape = \"capsule\" or \"cylinder\"", [](const S& s) { return s.tool.shape == ToolShape::capsule || s.tool.shape == ToolShape::cylinder; }},
      tool_cylinder = Condition<S>{"tool.shape", "tool.shape = \"cylinder\"", [](const S& s) { return s.tool.shape == ToolShape::cylinder; }},
      tool_box = Condition<S>{"tool.shape", "tool.shape = \"box\"", [](const S& s) { return s.tool.shape == ToolShape::box; }},
      tool_mesh = Condition<S>{"tool.shape", "tool.shape = \"mesh\"", [](const S& s) { return s.tool.shape == ToolShape::mesh; }},
      inclusions = Condition<S>{"body.inclusion", "at least one [[body.inclusion]]", [](const S& s) { return !s.body.inclusions.empty(); }},
      duffing = Condition<S>{"contact.law", "contact.law = \"duffing\"", [](const S& s) { return s.contact.law == ContactLaw::duffing; }},
      area_aware = Condition<S>{"contact.law", "contact.law = \"area_aware\"", [](const S& s) { return s.contact.law == ContactLaw::area_aware; }},
      friction = Condition<S>{"contact.friction", "[contact.friction] given", [](const S& s) { return s.contact.friction.has_value(); }};
  const std::optional<std::string_view> required, absent;
  constexpr Side both = Side::both, fast = Side::fast, reference = Side::reference, refinement = Side::refinement,
                 live = Side::live, none = Side::none;
  const std::optional<Tunable> law = Tunable{TuningStage::model}, force = Tunable{TuningStage::force},
                               shape = Tunable{TuningStage::shape}, rough_shape = Tunable{TuningStage::shape, true}, no;
  const Range any;
  std::vector<Field<S>> fields = {
      // key, unit, range, default, whose result it changes, where it is stored, when it applies,
      //     meaning, may it be tuned, a default that follows from other values
      {"title", "", any, "\"\"", none, +[](S& s) -> std::string& { return s.title; }, always,
           "Title of the scene, for reports."},

      {"body.support", "", any, "\"bottom\"", both, choice({"bottom"}, +[](S& s) -> Support& { return s.body.support; }), always,
           "Which part of the surface is fixed: a flat bottom face, else the lowest cap."},
      {"body.support_height_m", "m", above(0.0, 10.0), required, both, +[](S& s) -> double& { return s.body.support_height_m; }, body_round,
           "The surface below this height is fixed."},
      {"body.material.youngs_modulus_pa", "Pa", above(0.0, 1e13), required, both, +[](S& s) -> double& { return s.body.material.youngs_modulus_pa; }, always,
           "Young's modulus E of the body."},
      {"body.material.poissons_ratio", "", between(0.0, 0.5), required, both, +[](S& s) -> double& { return s.body.material.poissons_ratio; }, always,
           "Poisson's ratio nu; exactly 0.5 is incompressible."},

      {"tool.shape", "", any, required, both, choice({"sphere", "capsule", "cylinder", "box", "mesh"}, +[](S& s) -> ToolShape& { return s.tool.shape; }), always,
           "Shape of the rigid tool; capsule and cylinder lie along the tool's z axis."},
      {"tool.radius_m", "m", between(1e-5, 10.0), required, both, +[](S& s) -> double& { return s.tool.radius_m; }, tool_round,
           "Radius of the tool."},
      {"tool.length_m", "m", between(0.0, 10.0), required, both, +[](S& s) -> double& { return s.tool.length_m; }, tool_long,
           "Length of a capsule's straight part, or of a cylinder from end to end."},
      {"tool.edge_radius_m", "m", between(0.0, 10.0), "0.0", both, +[](S& s) -> double& { return s.tool.edge_radius_m; }, tool_cylinder,
           "Radius of the fillet at both rims; 0 for sharp ones. The reference refuses less than a quarter of tool.radius_m."},
      {"tool.size_m", "m", between(1e-5, 10.0), required, both, +[](S& s) -> Vec3& { return s.tool.size_m; }, tool_box,
           "Edge lengths of the box along the tool's x, y, z."},
      {"tool.file", "", any, required, both, +[](S& s) -> std::string& { return s.tool.file; }, tool_mesh,
           "Closed triangle mesh (.stl, .obj or .ply), its path relative to the scene file."},
      {"tool.unit", "", any, required, both, choice({"m", "cm", "mm", "in"}, +[](S& s) -> LengthUnit& { return s.tool.unit; }), tool_mesh,
           "Unit of the mesh file's coordinates."},
      {"tool.mass_kg", "kg", above(0.0, 1e3), "1.0", fast, +[](S& s) -> double& { return s.tool.mass_kg; }, always,
           "Mass m of the tool; k1 and k3 contain its size already, so only its distribution over the contact points matters."},
      {"tool.mass_center_m", "m", between(-10.0, 10.0), absent, both, +[](S& s) -> std::optional<Vec3>& { return s.tool.mass_center_m; }, always,
           "Mass centre, from the shape's centre or in the mesh's own axes; a track gives its poses. Absent: that of a uniform solid."},

      {"contact.law", "", any, "\"duffing\"", fast, choice(law_words(), +[](S& s) -> ContactLaw& { return s.contact.law; }), always,
           "Contact law of the fast model.", law},
      {"contact.k1_n_per_m", "N/m", between(0.0, 1e12), required, fast, +[](S& s) -> double& { return s.contact.k1_n_per_m; }, duffing,
           "Linear constant k1 = m w0^2 of F = k1 D + k3 D^3.", Tunable{.stage = TuningStage::force, .per_mass = PerMass{"contact.omega0_squared_per_s2", "1/s^2", 1.0}}},
      {"contact.k1_per_radius_n_per_m2", "N/m^2", between(0.0, 1e15), required, fast, +[](S& s) -> double& { return s.contact.k1_per_radius_n_per_m2; }, area_aware,
           "k1 = this times the contact radius sqrt(A/pi), A the tool's area under the rest surface.", force},
      {"contact.k3_n_per_m3", "N/m^3", between(-1e18, 1e18), required, fast, +[](S& s) -> double& { return s.contact.k3_n_per_m3; }, always,
           "Cubic constant k3 = (3/4) m b0^2 eps; negative is a softening law.", Tunable{.stage = TuningStage::force, .per_mass = PerMass{"contact.epsilon_beta0_squared_per_m2_s2", "1/(m^2 s^2)", 0.75}}},
      {"contact.r_th_m", "m", above(0.0, 1.0), required, both, +[](S& s) -> double& { return s.contact.r_th_m; }, always,
           "r_th: contact points closer than this belong to one contact region, for both solvers; a convex tool is always in one.", no,
           +[](const S& s) { return three_digits(body_size_m(s.body) / 15.0); }, "L / 15"},
      {"contact.friction.K", "N^(1-beta)", between(0.0, 1e6), required, both, +[](S& s) -> double& { return s.contact.friction->K; }, friction,
           "K of the static limit f_max = K F_n^beta; absent in a scene without friction.", force},
      {"contact.friction.beta", "", between(2.0 / 3.0, 1.0), required, both, +[](S& s) -> double& { return s.contact.friction->beta; }, friction,
           "beta of the static limit; 2/3 for a truly elastic solid.", force},
      {"contact.friction.mu_D", "", between(0.0, 10.0), required, both, +[](S& s) -> double& { return s.contact.friction->mu_D; }, friction,
           "Dynamic friction coefficient.", force},
      {"contact.friction.stiffness_ratio", "", between(1e-3, 1e3), "1.0", fast, +[](S& s) -> double& { return s.contact.friction->stiffness_ratio; }, friction,
           "kappa: stiffness F_t / D_t of the sticking contact over F_n / D_n; 1 as in the paper. Only the corrected formulation allows other values.", Tunable{.stage = TuningStage::force, .formulations = {Formulation::corrected}}},

      {"fast.formulation", "", any, "\"corrected\"", fast, choice({std::begin(formulation_words), std::end(formulation_words)}, +[](S& s) -> Formulation& { return s.fast.formulation; }), always,
           "The paper's printed method, its corrected form, or the response model, which reads what `touchstone prepare` computes.", Tunable{.stage = TuningStage::model, .formulations = {Formulation::published, Formulation::corrected, Formulation::response}}},
      {"fast.triangles", "", between(12, 1e5), "3952", fast, +[](S& s) -> int& { return s.fast.triangles; }, always,
           "Triangles of the body's surface; their corners are the rest points compared. Times compare.instants at most 1e7."},
      {"fast.tool_samples", "", between(1, 1e5), "2000", fast, +[](S& s) -> int& { return s.fast.tool_samples; }, always,
           "Points on the tool's surface. The corrected form takes cells: a quarter as many, at most 500 of a convex tool, "
           "and smaller ones in the contact."},
      {"fast.rate_hz", "Hz", between(1.0, 1e5), "1000.0", fast, +[](S& s) -> double& { return s.fast.rate_hz; }, always,
           "Ticks per second of virtual time."},
      {"fast.max_regions", "", between(1, 64), "10", fast, +[](S& s) -> int& { return s.fast.max_regions; }, tool_mesh,
           "Largest number of contact regions at a time; 1 takes all contact points as one region. A convex tool on a convex body has one."},
      {"fast.r_R_m", "m", above(0.0, 10.0), required, fast, +[](S& s) -> double& { return s.fast.r_R_m; }, always,
           "r_R: radius of the local neighbourhood R.", rough_shape,
           +[](const S& s) { return three_digits(body_size_m(s.body) / 4.0); }, "L / 4"},
      {"fast.C_n", "", between(0.0, 1e3), "0.2", fast, +[](S& s) -> double& { return s.fast.C_n; }, always,
           "C_n: strength of the local factor; 0 turns it off.", shape},
      {"fast.C_r_m", "m", above(0.0, 10.0), required, fast, +[](S& s) -> double& { return s.fast.C_r_m; }, always,
           "C_r: core radius of the local factor.", rough_shape,
           +[](const S& s) { return three_digits(body_size_m(s.body) / 30.0); }, "L / 30"},
      {"fast.s_c_m2", "m^2", above(0.0, 1e3), required, fast, +[](S& s) -> double& { return s.fast.s_c_m2; }, always,
           "s_c: cross-section area of all beams together.", shape,
           +[](const S& s) { return three_digits(body_size_m(s.body) * body_size_m(s.body) / 3.6); }, "L^2 / 3.6"},
      {"fast.body_falloff_per_m", "1/m", between(0.0, 1e5), "0.0", fast, +[](S& s) -> double& { return s.fast.body_falloff_per_m; }, inclusions,
           "Response model: kappa of the body's compliance C / sqrt(1 + (kappa a)^4), a the radius of Hertz's contact of the same force and indentation; 0: C.", Tunable{.stage = TuningStage::force, .formulations = {Formulation::response}}},

      {"live.force_max_n", "N", above(0.0, 1e4), "40.0", live, +[](S& s) -> double& { return s.live.force_max_n; }, always,
           "Device loop: largest norm of the force sent to the device."},
      {"live.force_slew_n_per_s", "N/s", above(0.0, 1e9), "2.0e4", live, +[](S& s) -> double& { return s.live.force_slew_n_per_s; }, always,
           "Device loop: largest rate of change of that force."},
      {"live.release_s", "s", above(0.0, 10.0), "0.1", live, +[](S& s) -> double& { return s.live.release_s; }, always,
           "Device loop: after an invalid pose the force falls to zero in this time."},
      {"live.hand_mass_kg", "kg", above(0.0, 100.0), "0.2", live, +[](S& s) -> double& { return s.live.hand_mass_kg; }, always,
           "Virtual hand: its mass with the tool's handle."},
      {"live.hand_damping_n_s_per_m", "N s/m", between(0.0, 1e4), "5.0", live, +[](S& s) -> double& { return s.live.hand_damping_n_s_per_m; }, always,
           "Virtual hand: damper between hand and track."},
      {"live.hand_stiffness_n_per_m", "N/m", above(0.0, 1e6), "500.0", live, +[](S& s) -> double& { return s.live.hand_stiffness_n_per_m; }, always,
           "Virtual hand: spring between hand and track."},

      {"reference.kinematics", "", any, "\"finite\"", reference, choice({"finite", "small"}, +[](S& s) -> Kinematics& { return s.reference.kinematics; }), always,
           "Finite strain, or small strain for closed forms."},
      {"reference.error", "", between(1e-4, 0.5), "0.01", refinement, +[](S& s) -> double& { return s.reference.error; }, always,
           "Meshes are refined until the uncertainties of force and shape, relative, are at most this."},
      {"reference.levels", "", between(1, 9), absent, refinement, +[](S& s) -> std::optional<int>& { return s.reference.levels; }, always,
           "Number of refined meshes in place of reference.error; an uncertainty needs at least 3."},
      {"reference.element_size_m", "m", above(0.0, 1.0), absent, reference, +[](S& s) -> std::optional<double>& { return s.reference.element_size_m; }, always,
           "Element size under the tool on the coarsest mesh; chosen from the contact radius when absent."},
      {"reference.adaptive_share", "", between(0.05, 1.0), absent, reference, +[](S& s) -> std::optional<double>& { return s.reference.adaptive_share; }, always,
           "Each mesh divides this share of the coarser one's cells, those with the largest estimated error; absent: a fixed family of meshes."},

      {"compare.instants", "", between(2, 2000), "25", both, +[](S& s) -> int& { return s.compare.instants; }, always,
           "Evenly spaced track instants at which both sides are recorded."},
  };
  const auto body = solid_fields<S, solid_of>("body.");
  fields.insert(fields.begin() + 1, body.begin(), body.end());
  return fields;
}

std::vector<Field<Inclusion>> make_inclusion_fields() {
  using I = Inclusion;
  std::vector<Field<I>> fields = solid_fields<I, solid_of>("");
  fields.push_back({"center_m", "m", between(-10.0, 10.0), {}, Side::both, +[](I& i) -> Vec3& { return i.center_m; }, {},
       "Centre of the inclusion's bounding box in the body at rest."});
  fields.push_back({"material.youngs_modulus_pa", "Pa", above(0.0, 1e13), {}, Side::both, +[](I& i) -> double& { return i.material.youngs_modulus_pa; }, {},
       "Young's modulus of the inclusion."});
  fields.push_back({"material.poissons_ratio", "", between(0.0, 0.5), {}, Side::both, +[](I& i) -> double& { return i.material.poissons_ratio; }, {},
       "Poisson's ratio of the inclusion."});
  return fields;
}

std::vector<Field<Probe>> make_probe_fields() {
  using P = Probe;
  return {
      {"name", "", Range{}, {}, Side::probes, +[](P& p) -> std::string& { return p.name; }, {},
           "Name of the point in probes.csv; without comma or quotation mark, and of one probe only."},
      {"position_m", "m", between(-20.0, 20.0), {}, Side::probes, +[](P& p) -> Vec3& { return p.position_m; }, {},
           "Point in the body at rest or on its surface. The reference reports its displacement, stress and pressure."},
  };
}

std::vector<Field<TrackRow>> make_track_fields() {
  using R = TrackRow;
  return {
      {"time_s", "s", between(-1e5, 1e5), {}, Side::both, +[](R& r) -> double& { return r.time_s; }, {},
           "Time of the pose, increasing from row to row."},
      {"position_m", "m", between(-1e3, 1e3), {}, Side::both, +[](R& r) -> OpenPosition& { return r.position; }, {},
           "Tool frame origin (mass centre) in the world."},
      {"depth_m", "m", between(-1e3, 1e3), {}, Side::both, +[](R& r) -> std::optional<double>& { return r.depth_m; }, {},
           "In place of the height: how far the tool has moved straight down since it first touched the undeformed body; negative: so far before that."},
      {"direction", "", between(-1e3, 1e3), {}, Side::both, +[](R& r) -> std::optional<Vec3>& { return r.direction; }, {},
           "Only with `depth_m`: the direction to move in, of any non-zero length, along the line through `position_m` = [x, y, z]. Absent: straight down, [0, 0, -1]."},
      {"orientation_wxyz", "", between(-orientation_norm_max, orientation_norm_max), "[1.0, 0.0, 0.0, 0.0]", Side::both, +[](R& r) -> Eigen::Quaterniond& { return r.orientation; }, {},
           "Quaternion of the tool frame; it is normalised."},
  };
}
// clang-format on

}  // namespace

const std::vector<Field<Scene>>& scene_fields() {
  static const std::vector<Field<Scene>> fields = make_scene_fields();
  return fields;
}

const Field<Scene>* tunable_field(std::string_view name) {
  const auto found = std::ranges::find_if(scene_fields(), [&](const Field<Scene>& field) {
    return field.tunable && (field.key == name || (field.tunable->per_mass && field.tunable->per_mass->key == name));
  });
  return found == scene_fields().end() ? nullptr : &*found;
}

bool tunable_in(const Field<Scene>& field, Formulation formulation) {
  return field.tunable && std::ranges::count(field.tunable->formulations, formulation) != 0;
}

std::vector<const Field<Scene>*> tunable_fields(const Scene& scene) {
  std::vector<const Field<Scene>*> list;
  for (const Field<Scene>& field : scene_fields()) {
    if (tunable_in(field, scene.fast.formulation) && applies(field, scene)) list.push_back(&field);
  }
  return list;
}

std::string former_name_message(std::string_view key) {
  struct Former {
    std::string_view name, now, why;
  };
  constexpr Former names[] = {{"fast.r_th_m", "contact.r_th_m", "because the reference reads it too"}};
  for (const Former& former : names) {
    if (former.name == key)
      return std::string(key) + " is " + std::string(former.now) + " now, " + std::string(former.why);
  }
  return "";
}

const std::vector<Field<Inclusion>>& inclusion_fields() {
  static const std::vector<Field<Inclusion>> fields = make_inclusion_fields();
  return fields;
}

const std::vector<OptionalTable>& optional_tables() {
  static const std::vector<OptionalTable> tables = {
      {"contact.friction", [](Scene& s) { s.contact.friction.emplace(); }},
  };
  return tables;
}

const std::vector<Field<Probe>>& probe_fields() {
  static const std::vector<Field<Probe>> fields = make_probe_fields();
  return fields;
}

bool in_optional_table(const Field<Scene>& field) {
  return field.only_when &&
         std::ranges::find(optional_tables(), field.only_when->key, &OptionalTable::key) != optional_tables().end();
}

const std::vector<Field<TrackRow>>& track_fields() {
  static const std::vector<Field<TrackRow>> fields = make_track_fields();
  return fields;
}

const Field<TrackRow>& track_field(std::string_view key) {
  return *std::ranges::find(track_fields(), key, &Field<TrackRow>::key);
}

namespace {

template <class Numbers>
std::string numbers(const Numbers& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number_text(value);
  return "[" + text + "]";
}

}  // namespace

template <class T>
std::string value_text(const Field<T>& field, const T& object) {
  T& o = const_cast<T&>(object);  // the accessors serve reading and writing; here only reading
  struct Visitor {
    T& o;
    std::string operator()(double& (*at)(T&)) const { return number_text(at(o)); }
    std::string operator()(int& (*at)(T&)) const { return std::to_string(at(o)); }
    std::string operator()(std::string& (*at)(T&)) const { return toml_quoted(at(o)); }
    std::string operator()(std::optional<double>& (*at)(T&)) const { return at(o) ? number_text(*at(o)) : ""; }
    std::string operator()(std::optional<int>& (*at)(T&)) const { return at(o) ? std::to_string(*at(o)) : ""; }
    std::string operator()(Vec3& (*at)(T&)) const { return numbers(at(o)); }
    std::string operator()(std::optional<Vec3>& (*at)(T&)) const { return at(o) ? numbers(*at(o)) : ""; }
    std::string operator()(std::vector<double>& (*at)(T&)) const { return numbers(at(o)); }
    std::string operator()(std::vector<Eigen::Vector2d>& (*at)(T&)) const {
      std::string text;
      for (const Eigen::Vector2d& pair : at(o)) text += (text.empty() ? "" : ", ") + numbers(pair);
      return "[" + text + "]";
    }
    std::string operator()(OpenPosition& (*at)(T&)) const {
      const OpenPosition& p = at(o);
      return p.height_open ? numbers(Eigen::Vector2d(p.position_m.head<2>())) : numbers(p.position_m);
    }
    std::string operator()(Eigen::Quaterniond& (*at)(T&)) const {
      const Eigen::Quaterniond& q = at(o);
      return numbers(std::array{q.w(), q.x(), q.y(), q.z()});
    }
    std::string operator()(const Choice<T>& access) const {
      return toml_quoted(std::string(nth(access.names, access.get(o))));
    }
  };
  return std::visit(Visitor{o}, field.access);
}

template <class T>
std::string expected_text(const Field<T>& field) {
  if (const auto* access = std::get_if<Choice<T>>(&field.access)) {
    std::string out;
    for (const std::string_view name : access->names) {
      out += (out.empty() ? "" : " or ") + toml_quoted(std::string(name));
    }
    return out;
  }
  if (std::holds_alternative<std::string& (*)(T&)>(field.access))
    return std::string("a text") + (field.default_value ? "" : ", not empty,") + " without control characters";
  std::string out = "a number in ";
  if (std::holds_alternative<Vec3& (*)(T&)>(field.access) ||
      std::holds_alternative<std::optional<Vec3>& (*)(T&)>(field.access)) {
    out = "three numbers, each in ";
  } else if (std::holds_alternative<OpenPosition& (*)(T&)>(field.access)) {
    out = "three numbers [x, y, z], or two [x, y] with depth_m, each in ";
  } else if (std::holds_alternative<Eigen::Quaterniond& (*)(T&)>(field.access)) {
    out = "four numbers of a norm in " + orientation_norm.text() + ", each in ";
  } else if (std::holds_alternative<int& (*)(T&)>(field.access) ||
             std::holds_alternative<std::optional<int>& (*)(T&)>(field.access)) {
    out = "a whole number in ";
  } else if (std::holds_alternative<std::vector<double>& (*)(T&)>(field.access)) {
    out = "a list of numbers, each in ";
  } else if (std::holds_alternative<std::vector<Eigen::Vector2d>& (*)(T&)>(field.access)) {
    out = "a list of pairs [r, z], each number in ";
  }
  out += field.range.text();
  if (!field.unit.empty()) out += " " + std::string(field.unit);
  return out;
}

template std::string value_text(const Field<Scene>&, const Scene&);
template std::string value_text(const Field<TrackRow>&, const TrackRow&);
template std::string value_text(const Field<Inclusion>&, const Inclusion&);
template std::string value_text(const Field<Probe>&, const Probe&);
template std::string expected_text(const Field<Scene>&);
template std::string expected_text(const Field<TrackRow>&);
template std::string expected_text(const Field<Inclusion>&);
template std::string expected_text(const Field<Probe>&);

namespace {

/// In the order of the enumeration.
constexpr std::array<const char*, 7> side_names = {"both", "fast", "reference", "refinement", "probes", "live", "none"};

template <class T>
std::string reference_rows(const std::vector<Field<T>>& fields, const std::string& prefix) {
  std::string out;
  for (const auto& field : fields) {
    out += "| `" + prefix + std::string(field.key) + "` | " + expected_text(field) + " | " +
           (field.default_value ? "`" + std::string(*field.default_value) + "`"
            : field.default_of  ? "`" + std::string(field.default_words) + "`"
            : optional(field)   ? "absent"
                                : "required") +
           " | " + nth(side_names, field.side) + " | " + std::string(field.doc);
    if (field.only_when) out += " Only with `" + std::string(field.only_when->text) + "`.";
    out += " |\n";
  }
  return out;
}

}  // namespace

std::string scene_reference_markdown() {
  return "| key | value | default | changes | meaning |\n|---|---|---|---|---|\n" + reference_rows(scene_fields(), "") +
         reference_rows(inclusion_fields(), "body.inclusion[].") + reference_rows(probe_fields(), "probe[].") +
         reference_rows(track_fields(), "track[].");
}

}  // namespace touchstone::scene
