#include "scene/fields.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

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

std::string toml_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// A table reads best with one key per row.
// clang-format off
std::vector<Field<Scene>> make_scene_fields() {
  using S = Scene;
  const std::optional<Condition> always, box = Condition{"body.shape", "box"}, ball = Condition{"body.shape", "sphere"};
  const std::optional<std::string_view> required, absent;
  constexpr Side shared = Side::shared, fast = Side::fast, reference = Side::reference, compare = Side::compare;
  const Range any;
  return {
      // key, unit, range, default, who reads it, where it lives, when it applies,
      //     meaning
      {"title", "", any, "\"\"", compare, +[](S& s) -> std::string& { return s.title; }, always,
           "What the scene shows, for reports."},

      {"body.shape", "", any, required, shared, choice({"box", "sphere"}, +[](S& s) -> BodyShape& { return s.body.shape; }), always,
           "Shape of the elastic body; its lowest point is on z = 0, its centre on the z axis."},
      {"body.size_m", "m", between(1e-4, 10.0), required, shared, +[](S& s) -> Vec3& { return s.body.size_m; }, box,
           "Edge lengths of the box along x, y, z."},
      {"body.radius_m", "m", between(1e-4, 10.0), required, shared, +[](S& s) -> double& { return s.body.radius_m; }, ball,
           "Radius of the sphere."},
      {"body.support", "", any, "\"bottom\"", shared, choice({"bottom"}, +[](S& s) -> Support& { return s.body.support; }), always,
           "Which surface region is held: the box's lowest face, the sphere's lowest cap."},
      {"body.support_height_m", "m", above(0.0, 10.0), required, shared, +[](S& s) -> double& { return s.body.support_height_m; }, ball,
           "The sphere's surface below this height is held."},
      {"body.material.youngs_modulus_pa", "Pa", above(0.0, 1e13), required, shared, +[](S& s) -> double& { return s.body.material.youngs_modulus_pa; }, always,
           "Young's modulus E of the body."},
      {"body.material.poissons_ratio", "", between(0.0, 0.5), required, shared, +[](S& s) -> double& { return s.body.material.poissons_ratio; }, always,
           "Poisson's ratio nu; exactly 0.5 is incompressible."},

      {"tool.shape", "", any, required, shared, choice({"sphere"}, +[](S& s) -> ToolShape& { return s.tool.shape; }), always,
           "Shape of the rigid tool."},
      {"tool.radius_m", "m", between(1e-5, 10.0), required, shared, +[](S& s) -> double& { return s.tool.radius_m; }, always,
           "Radius of the tool."},
      {"tool.mass_kg", "kg", above(0.0, 1e3), "1.0", fast, +[](S& s) -> double& { return s.tool.mass_kg; }, always,
           "Mass m of the tool; k1 and k3 hold its size already, only its shares over the contact points count."},

      {"contact.law", "", any, "\"duffing\"", fast, choice({"duffing"}, +[](S& s) -> ContactLaw& { return s.contact.law; }), always,
           "Contact law of the fast model."},
      {"contact.k1_n_per_m", "N/m", between(0.0, 1e12), required, fast, +[](S& s) -> double& { return s.contact.k1_n_per_m; }, always,
           "Linear constant k1 = m w0^2 of F = k1 D + k3 D^3."},
      {"contact.k3_n_per_m3", "N/m^3", between(-1e18, 1e18), required, fast, +[](S& s) -> double& { return s.contact.k3_n_per_m3; }, always,
           "Cubic constant k3 = (3/4) m b0^2 eps; negative is a softening law."},

      {"fast.formulation", "", any, "\"corrected\"", fast, choice({"published", "corrected"}, +[](S& s) -> Formulation& { return s.fast.formulation; }), always,
           "The paper's printed method, or its corrected form."},
      {"fast.triangles", "", between(12, 1e6), "3952", fast, +[](S& s) -> int& { return s.fast.triangles; }, always,
           "Triangles on the body; their corners are the rest points compared."},
      {"fast.tool_samples", "", between(1, 1e5), "2000", fast, +[](S& s) -> int& { return s.fast.tool_samples; }, always,
           "Points on the tool's surface."},
      {"fast.rate_hz", "Hz", between(1.0, 1e5), "1000.0", fast, +[](S& s) -> double& { return s.fast.rate_hz; }, always,
           "Ticks per second of virtual time."},
      {"fast.r_th_m", "m", above(0.0, 1.0), "0.004", fast, +[](S& s) -> double& { return s.fast.r_th_m; }, always,
           "r_th: contact points closer than this belong to one contact region; a ball on a convex body is always one."},
      {"fast.r_R_m", "m", above(0.0, 10.0), "0.015", fast, +[](S& s) -> double& { return s.fast.r_R_m; }, always,
           "r_R: radius of the local neighbourhood R."},
      {"fast.C_n", "", between(0.0, 1e3), "0.2", fast, +[](S& s) -> double& { return s.fast.C_n; }, always,
           "C_n: strength of the local factor; 0 leaves it out."},
      {"fast.C_r_m", "m", above(0.0, 10.0), "0.002", fast, +[](S& s) -> double& { return s.fast.C_r_m; }, always,
           "C_r: core radius of the local factor."},
      {"fast.s_c_m2", "m^2", above(0.0, 1e3), "1.0e-3", fast, +[](S& s) -> double& { return s.fast.s_c_m2; }, always,
           "s_c: cross-section area of all beams together."},

      {"reference.kinematics", "", any, "\"finite\"", reference, choice({"finite", "small"}, +[](S& s) -> Kinematics& { return s.reference.kinematics; }), always,
           "Finite strain, or small strain for closed forms."},
      {"reference.levels", "", between(1, 6), "3", reference, +[](S& s) -> int& { return s.reference.levels; }, always,
           "Refined meshes; an uncertainty needs at least 3."},
      {"reference.element_size_m", "m", above(0.0, 1.0), absent, reference, +[](S& s) -> std::optional<double>& { return s.reference.element_size_m; }, always,
           "Element size under the tool on the coarsest mesh; chosen from the contact radius when absent."},

      {"compare.instants", "", between(2, 10000), "25", shared, +[](S& s) -> int& { return s.compare.instants; }, always,
           "Evenly spaced track instants at which both sides are recorded."},
  };
}

std::vector<Field<Waypoint>> make_waypoint_fields() {
  using W = Waypoint;
  return {
      {"time_s", "s", between(-1e9, 1e9), {}, Side::shared, +[](W& w) -> double& { return w.time_s; }, {},
           "Time of the pose, increasing from row to row."},
      {"position_m", "m", between(-1e3, 1e3), {}, Side::shared, +[](W& w) -> Vec3& { return w.pose.position_m; }, {},
           "Tool frame origin (mass centre) in the world."},
      {"orientation_wxyz", "", between(-1e3, 1e3), "[1.0, 0.0, 0.0, 0.0]", Side::shared, +[](W& w) -> Eigen::Quaterniond& { return w.pose.orientation; }, {},
           "Quaternion of the tool frame, of any non-zero length."},
  };
}
// clang-format on

}  // namespace

std::string number_text(double value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  std::string out(text, end.ptr);
  if (out.find_first_of(".en") == std::string::npos) out += ".0";
  return out;
}

bool Range::contains(double value) const noexcept {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  char out[80];
  std::snprintf(out, sizeof out, "%c%g, %g%c", low_open ? '(' : '[', low, high, high_open ? ')' : ']');
  return out;
}

const std::vector<Field<Scene>>& scene_fields() {
  static const std::vector<Field<Scene>> fields = make_scene_fields();
  return fields;
}

const std::vector<Field<Waypoint>>& waypoint_fields() {
  static const std::vector<Field<Waypoint>> fields = make_waypoint_fields();
  return fields;
}

bool applies(const Field<Scene>& field, const Scene& scene) {
  if (!field.only_when) return true;
  const auto& fields = scene_fields();
  const auto other =
      std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.key == field.only_when->key; });
  const auto& access = std::get<Choice<Scene>>(other->access);
  return access.names[static_cast<std::size_t>(access.get(scene))] == field.only_when->value;
}

template <class T>
std::string value_text(const Field<T>& field, const T& object) {
  T& o = const_cast<T&>(object);  // the accessors serve reading and writing; this only reads
  struct Visitor {
    T& o;
    std::string operator()(double& (*at)(T&)) const { return number_text(at(o)); }
    std::string operator()(int& (*at)(T&)) const { return std::to_string(at(o)); }
    std::string operator()(std::string& (*at)(T&)) const { return toml_quoted(at(o)); }
    std::string operator()(std::optional<double>& (*at)(T&)) const { return at(o) ? number_text(*at(o)) : ""; }
    std::string operator()(Vec3& (*at)(T&)) const {
      const Vec3& v = at(o);
      return "[" + number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z()) + "]";
    }
    std::string operator()(Eigen::Quaterniond& (*at)(T&)) const {
      const Eigen::Quaterniond& q = at(o);
      return "[" + number_text(q.w()) + ", " + number_text(q.x()) + ", " + number_text(q.y()) + ", " +
             number_text(q.z()) + "]";
    }
    std::string operator()(const Choice<T>& access) const {
      return toml_quoted(std::string(access.names[static_cast<std::size_t>(access.get(o))]));
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
  if (std::holds_alternative<std::string& (*)(T&)>(field.access)) return "a text";
  std::string out = std::holds_alternative<Vec3& (*)(T&)>(field.access)                 ? "three numbers, each in "
                    : std::holds_alternative<Eigen::Quaterniond& (*)(T&)>(field.access) ? "four numbers, each in "
                    : std::holds_alternative<int& (*)(T&)>(field.access)                ? "a whole number in "
                                                                                        : "a number in ";
  out += field.range.text();
  if (!field.unit.empty()) out += " " + std::string(field.unit);
  return out;
}

template std::string value_text(const Field<Scene>&, const Scene&);
template std::string value_text(const Field<Waypoint>&, const Waypoint&);
template std::string expected_text(const Field<Scene>&);
template std::string expected_text(const Field<Waypoint>&);

namespace {

template <class T>
std::string reference_rows(const std::vector<Field<T>>& fields, const std::string& prefix) {
  std::string out;
  for (const auto& field : fields) {
    const bool optional = std::holds_alternative<std::optional<double>& (*)(T&)>(field.access);
    out += "| `" + prefix + std::string(field.key) + "` | " + expected_text(field) + " | " +
           (field.default_value ? "`" + std::string(*field.default_value) + "`"
            : optional          ? "absent"
                                : "required") +
           " | " + std::string(field.doc);
    if (field.only_when) {
      out +=
          " Only with `" + std::string(field.only_when->key) + " = \"" + std::string(field.only_when->value) + "\"`.";
    }
    out += " |\n";
  }
  return out;
}

}  // namespace

std::string scene_reference_markdown() {
  return "| key | value | default | meaning |\n|---|---|---|---|\n" + reference_rows(scene_fields(), "") +
         reference_rows(waypoint_fields(), "track[].");
}

}  // namespace touchstone::scene
