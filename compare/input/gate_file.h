// Gate files: limits that results of a scene must keep, and files of waivers for limits wider than those of another
// commit. Every key: reports/gate-reference.md. In short:
//
//   title     = "Fast model, ball on cube"
//   run       = "fast"
//   scene     = "../../meshes/scenes/ball-on-cube-press.toml"
//   reference = "reference/ball-on-cube-press"
//
//   [[gate]]
//   name     = "force"
//   kind     = "truth"
//   quantity = "force.nrmse"
//   limit    = 0.02
//   unit     = ""
//   reason   = "why this limit"
//   red      = ["contact.k1_n_per_m=60"]
#pragma once

#include "scene/base/error.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::compare {

/// A key as the gate reference explains it; the reader refuses all others.
struct GateKey {
  std::string key;            ///< within its table
  std::string value;          ///< the allowed values
  std::string default_value;  ///< empty: it must be given
  std::string meaning;
};
[[nodiscard]] const std::vector<GateKey>& gate_file_keys();  ///< at the top of a gate file
[[nodiscard]] const std::vector<GateKey>& gate_keys();       ///< of a [[gate]] row
[[nodiscard]] const std::vector<GateKey>& waiver_keys();     ///< of a [[waiver]] row

/// All of them as a Markdown page: reports/gate-reference.md.
[[nodiscard]] std::string gate_reference_markdown();

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
  scene::Fault place;            ///< the place of its limit; its message is empty
};

struct GateFile {
  std::string name;  ///< file stem
  std::string title;
  GateRun run = GateRun::fast;
  std::string model;  ///< key of compare/model's; empty: the fast model
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
  scene::Fault place;
};

/// @throws InputError with every fault of the file, each with line, column and what was expected
[[nodiscard]] GateFile load_gate_file(const std::filesystem::path& file);

/// The same from text. @param file  for messages and for the paths in it
[[nodiscard]] GateFile parse_gate_file(std::string_view text, const std::filesystem::path& file);

/// None when there is no such file. @throws InputError alike
[[nodiscard]] std::vector<GateWaiver> load_gate_waivers(const std::filesystem::path& file);

}  // namespace touchstone::compare
