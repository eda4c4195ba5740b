// The scene's keys, declared once: parsing, error texts, `touchstone plan`, the resolved scene, the
// content hash and the scene reference in the documentation all read the tables below.
#pragma once

#include "scene/base/range.h"
#include "scene/model/scene.h"

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace touchstone::scene {

/// Whose answer a key's value changes. The reference's is that on one of its meshes, which is what its store keeps.
enum class Side {
  both,
  fast,
  reference,
  refinement,  ///< how many meshes the reference solves; the answer on each of them stays
  probes,      ///< what is read from the reference's answers; these stay
  live,        ///< the device loop and its virtual hand alone
  none         ///< words for the reader
};
[[nodiscard]] constexpr bool fast_reads(Side side) { return side == Side::both || side == Side::fast; }
[[nodiscard]] constexpr bool reference_reads(Side side) { return side == Side::both || side == Side::reference; }

/// Where the tuning takes a key from: which model it is follows from the study; then the force is fitted, then the
/// shape with the force that was found.
enum class TuningStage { model, force, shape };

/// Another name under which a constant is tuned: the constant is factor times tool.mass_kg times the value.
struct PerMass {
  std::string_view key, unit;
  double factor;
};

/// Properties of a key that tuning may change; its limits are the key's range.
struct Tunable {
  TuningStage stage;
  bool rough = false;  ///< the fit may have corners or steps in it
  std::vector<Formulation> formulations = {Formulation::published, Formulation::corrected};  ///< that have it
  std::optional<PerMass> per_mass = {};
};

/// A place whose height may be left open, as [x, y].
struct OpenPosition {
  Vec3 position_m = Vec3::Zero();
  bool height_open = false;  ///< z means nothing
};

/// One row of a track as a file gives it. Where the depth is given, the position along `direction` follows from it.
struct TrackRow {
  double time_s = 0.0;
  OpenPosition position;
  std::optional<double> depth_m;
  std::optional<Vec3> direction;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// Where a key's value is stored in a T (the Scene, one Inclusion, one Probe or one TrackRow).
template <class T>
struct Choice {
  std::vector<std::string_view> names;  ///< in the order of the enumeration
  std::function<int(const T&)> get;
  std::function<void(T&, int)> set;
};
template <class T>
using Access =
    std::variant<double& (*)(T&), int& (*)(T&), std::string& (*)(T&), std::optional<double>& (*)(T&),
                 std::optional<int>& (*)(T&), Vec3& (*)(T&), std::optional<Vec3>& (*)(T&), Eigen::Quaterniond& (*)(T&),
                 std::vector<double>& (*)(T&), std::vector<Eigen::Vector2d>& (*)(T&), OpenPosition& (*)(T&), Choice<T>>;

/// The key applies only where this holds; elsewhere giving it is an error.
template <class T>
struct Condition {
  std::string_view key;   ///< of the value it depends on
  std::string_view text;  ///< in TOML: body.shape = "box"
  bool (*holds)(const T&) = nullptr;
};

/// A table that a scene may leave out altogether; its keys apply only where it is given.
struct OptionalTable {
  std::string_view key;
  void (*give)(Scene&);
};
[[nodiscard]] const std::vector<OptionalTable>& optional_tables();

template <class T>
struct Field {
  std::string_view key;   ///< dotted, with the unit as suffix
  std::string_view unit;  ///< SI; empty for a pure number, a word or a text
  Range range;
  std::optional<std::string_view> default_value;  ///< as TOML; a key without one must be given, unless optional
  Side side;
  Access<T> access;
  std::optional<Condition<T>> only_when;
  std::string_view doc;                 ///< one line
  std::optional<Tunable> tunable = {};  ///< absent: the tuning and its files of parameters leave it alone
  /// A default that follows from the scene's other values, and in words; the key then has no other default.
  double (*default_of)(const T&) = nullptr;
  std::string_view default_words = {};
};

/// Every key of a scene file but the track's.
[[nodiscard]] const std::vector<Field<Scene>>& scene_fields();

/// The constant or choice of model that a tuning has under this name, its key or that per mass; null where none has it.
[[nodiscard]] const Field<Scene>* tunable_field(std::string_view name);

/// Is it a constant or choice of this formulation of the fast model that a tuning may change?
[[nodiscard]] bool tunable_in(const Field<Scene>& field, Formulation formulation);

/// Those that are in force in a scene, of its formulation.
[[nodiscard]] std::vector<const Field<Scene>*> tunable_fields(const Scene& scene);

/// The former name's message, "x is y now, ..."; empty for any other. Former names are refused, not read.
[[nodiscard]] std::string former_name_message(std::string_view key);

/// The keys of one [[track]] row.
[[nodiscard]] const std::vector<Field<TrackRow>>& track_fields();

/// One of them: its range holds for every source of a pose, a table's columns too.
[[nodiscard]] const Field<TrackRow>& track_field(std::string_view key);

/// The keys of one [[body.inclusion]] row.
[[nodiscard]] const std::vector<Field<Inclusion>>& inclusion_fields();

/// The keys of one [[probe]] row.
[[nodiscard]] const std::vector<Field<Probe>>& probe_fields();

/// Is the key's value in force (its condition holds)?
template <class T>
[[nodiscard]] bool applies(const Field<T>& field, const T& object) {
  return !field.only_when || field.only_when->holds(object);
}

/// May the key be left out without a default taking its place?
template <class T>
[[nodiscard]] bool optional(const Field<T>& field) {
  return std::holds_alternative<std::optional<double>& (*)(T&)>(field.access) ||
         std::holds_alternative<std::optional<int>& (*)(T&)>(field.access) ||
         std::holds_alternative<std::optional<Vec3>& (*)(T&)>(field.access);
}

/// Must every scene in which the key applies say it?
template <class T>
[[nodiscard]] bool must_be_given(const Field<T>& field) {
  return !field.default_value && !field.default_of && !optional(field);
}

/// Does the key apply only in a table that a scene may leave out?
[[nodiscard]] bool in_optional_table(const Field<Scene>& field);

/// The value as TOML; empty for an optional value that is absent.
template <class T>
[[nodiscard]] std::string value_text(const Field<T>& field, const T& object);

/// The allowed values in words: a range with unit, or the list of choices.
template <class T>
[[nodiscard]] std::string expected_text(const Field<T>& field);

/// The scene reference of the documentation, as a Markdown table.
[[nodiscard]] std::string scene_reference_markdown();

}  // namespace touchstone::scene
