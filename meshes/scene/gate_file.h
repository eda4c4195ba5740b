// Gate files: limits that results of a scene must keep. TOML:
//
//   title     = "Fast model, ball on cube"
//   run       = "fast"                                       # fast | reference: what is computed anew
//   scene     = "../../meshes/scenes/ball-on-cube-press.toml"   # relative to the gate file
//   set       = ["contact.k1_n_per_m=50"]                    # values over the scene's, as for --set
//   reference = "reference/ball-on-cube-press"               # folder of the committed reference data
//
//   [[gate]]
//   name     = "force"
//   kind     = "truth"          # truth: |value| + uncertainty <= limit; drift: |value - accepted| <= limit
//   quantity = "force.nrmse"    # a key of summary.json
//   limit    = 0.02
//   unit     = ""               # of the quantity; "" for a ratio
//   reason   = "why this limit"
//   red      = ["contact.k1_n_per_m=60"]   # what must turn the gate red, as for --set
//
// and a file of waivers, for limits wider than those of another commit:
//
//   [[waiver]]
//   gate    = "ball-on-cube-press.force"
//   name    = "who answers for it"
//   reason  = "why"
//   until   = 2026-12-31        # the last day on which it holds
//   removed = false             # true: it is for a gate that was taken away
#pragma once

#include "scene/error.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

enum class GateKind { truth, drift };
enum class GateRun { fast, reference, second_code };

/// As the gate file spells them.
[[nodiscard]] const char* name_of(GateKind kind);
[[nodiscard]] const char* name_of(GateRun run);

struct Gate {
  std::string name;  ///< within its file
  GateKind kind = GateKind::truth;
  std::string quantity;
  double limit = 0.0;  ///< above zero, in the quantity's unit
  std::string unit;
  std::string reason;
  std::vector<std::string> red;  ///< never empty
  Fault place;                   ///< where its limit stands; its message is empty
};

struct GateFile {
  std::string name;  ///< file stem
  std::string title;
  GateRun run = GateRun::fast;
  std::filesystem::path scene_file;
  std::vector<std::string> set;
  std::filesystem::path reference;  ///< empty: none
  std::vector<Gate> gates;          ///< never empty
};

struct GateWaiver {
  std::string gate;  ///< "file.gate"
  std::string name, reason;
  std::chrono::year_month_day until;
  bool removed = false;
  Fault place;
};

/// @throws InputError with every fault of the file, each with line, column and what was expected
[[nodiscard]] GateFile load_gate_file(const std::filesystem::path& file);

/// The same from text. @param file  for messages and for the paths in it
[[nodiscard]] GateFile parse_gate_file(std::string_view text, const std::filesystem::path& file);

/// None when there is no such file. @throws InputError alike
[[nodiscard]] std::vector<GateWaiver> load_gate_waivers(const std::filesystem::path& file);

}  // namespace touchstone::scene
