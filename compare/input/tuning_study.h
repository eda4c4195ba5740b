// Tuning studies: which contacts to fit the fast model on, which to judge it on, and what is free. TOML:
//
//   kind        = "tuning"
//   title       = "A ball on a rubber cube"
//   formulation = ["corrected", "published"]   # each is tuned for itself; the first gives parameters.toml
//                                              # "response", too; reports/scene-reference.md has its constant
//   law         = ["duffing", "area_aware"]    # the same; without it the contacts' own
//   starts      = 16                           # of every fit: the given one, the others spread over the bounds
//   force_floor = 0.01                         # least uncertainty of the reference, of a contact's peak force
//   shape_floor = 0.01                         # the same, of its displacement
//
//   [set]                                      # in every contact; keys as for --set
//   compare.instants = 23
//
//   [[training]]
//   name    = "middle"
//   scene   = "../scenes/ball-on-cube-press.toml"
//   set     = { tool.radius_m = 0.012 }
//   depth_m = [0.0, 0.004]                     # only the instants from the first depth up to and with the second
//
//   [[held_out]]                               # the same keys, and in what it differs from the training
//   name    = "15 mm off the middle"
//   differs = "place"                          # place | tool | depth | track | body
//   scene   = "../scenes/ball-on-cube-press.toml"
//   set     = { "track[0].position_m[0]" = 0.015, "track[1].position_m[0]" = 0.015 }
//
//   [[parameter]]
//   key     = "contact.k1_n_per_m"
//   bounds  = [1.0e3, 1.0e6]
//   start   = 4.0e4                            # without it the middle of the bounds
//   scale   = "log"                            # log | linear; without it log where both bounds are above 0
//   profile = true                             # fit the others at values along it; without it where a fit may be
//   rough: r_R_m, C_r_m
#pragma once

#include "compare/input/study_file.h"
#include "scene/input/fields.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// One contact of a tuning study.
struct TuningContact {
  std::string name;
  std::string differs;  ///< in what from the training; empty for a training contact
  scene::Scene scene;
  std::array<double, 2> depth_m = {0.0, 1e300};  ///< instants above the first up to and with the second count
};

using scene::TuningStage;

/// One free number of the fast model.
struct TuningParameter {
  std::string key;  ///< a name for scene::tunable_field
  std::string unit;
  TuningStage stage = TuningStage::force;
  double low = 0.0, high = 0.0;
  double start = 0.0;
  bool log = false;      ///< searched in its logarithm
  bool profile = false;  ///< the fit may be rough in it
};

struct TuningStudy {
  std::string name;  ///< file stem
  std::string title;
  std::vector<scene::Formulation> formulations;
  std::vector<scene::ContactLaw> laws;
  int starts = 16;
  double force_floor = 0.01, shape_floor = 0.01;
  std::vector<TuningContact> training, held_out;
  std::vector<TuningParameter> parameters;
};

/// Has the parameter a meaning in the model? The column `tunable` of the table of keys says so.
[[nodiscard]] bool applies(const TuningParameter& parameter, scene::Formulation formulation, scene::ContactLaw law);

/// Writes a value into a scene; nothing where the key does not apply, as friction's in a scene without it. omega0^2 and
/// epsilon beta0^2 become k1 = m omega0^2 and k3 = (3/4) m epsilon beta0^2 with the tool's mass, equation (1).
/// @param key  of a TuningParameter
void set_parameter(scene::Scene& scene, const std::string& key, double value);

/// Puts the values of a file that scenes include, such as `tune` leaves, over a scene's own: a contact law, a
/// formulation and what may be tuned. Friction's are left out where the scene has none.
/// @throws InputError with every fault of the file, each with line, column and what was expected
[[nodiscard]] scene::Scene with_parameters(scene::Scene scene, const std::filesystem::path& file);

/// @throws InputError with every fault of the file and of its contacts' scenes, each with line, column and what was
///         expected
/// @param check  more faults of one scene, such as what a solver cannot do; may be empty
[[nodiscard]] TuningStudy load_tuning_study(
    const std::filesystem::path& file, const std::function<std::vector<scene::Fault>(const scene::Scene&)>& check = {});

}  // namespace touchstone::compare
