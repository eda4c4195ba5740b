// One fuzz target for each kind of file that Touchstone reads. libFuzzer calls LLVMFuzzerTestOneInput with the bytes
// of a file; `--kind=NAME` on the command line says of which kind. A reader may accept the bytes or refuse them with
// its own error, whose text must be fit for a terminal. Anything else ends the process, and that is a finding.
#include "compare/result_folder.h"
#include "fast/live/live_log.h"
#include "reference/run/step_record.h"
#include "scene/error.h"
#include "scene/files.h"
#include "scene/gate_file.h"
#include "scene/hash.h"
#include "scene/mesh_formats.h"
#include "scene/scene_io.h"
#include "scene/study.h"
#include "scene/text.h"
#include "scene/track_csv.h"
#include "scene/triangle_mesh.h"
#include "scene/tuning_study.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace {

using namespace touchstone;
using std::filesystem::path;

const path source = TOUCHSTONE_SOURCE_DIR;

[[noreturn]] void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

/// A folder in memory with the shipped scenes, tools and studies, where the input becomes a file among them. Removed at
/// the end of the process.
class Folder {
 public:
  Folder() : path_(path("/dev/shm") / ("touchstone-fuzz-" + std::to_string(::getpid()))) {
    for (const char* part : {"scenes", "tools", "studies", "parameters"}) {
      std::filesystem::create_directories(path_ / part);
      std::filesystem::copy(source / "meshes" / part, path_ / part, std::filesystem::copy_options::overwrite_existing);
    }
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const path& root() const { return path_; }
  /// Makes the input a file of this name.
  path file(const path& name, const std::string& bytes) const {
    const path file = path_ / name;
    if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
      std::fwrite(bytes.data(), 1, bytes.size(), out);
      std::fclose(out);
    }
    return file;
  }

 private:
  path path_;
};

const Folder& folder() {
  static const Folder one;
  return one;
}

/// A message is text for a terminal, of a length that somebody reads.
void require_readable(const std::string& message) {
  constexpr std::size_t bytes_max = 64 << 10;
  if (message.empty() || message.size() > bytes_max)
    finding("a message of " + std::to_string(message.size()) + " bytes");
  for (std::string_view rest = message; !rest.empty();) {
    const std::size_t length = scene::utf8_length(rest);
    if (length == 0) finding("a message that is no UTF-8");
    if (rest[0] != '\n' && scene::is_control(rest, length)) finding("a control character in a message");
    rest.remove_prefix(length);
  }
}

void require_finite(const scene::TriangleMesh& mesh) {
  if (!mesh.points_m.allFinite()) finding("a mesh with a point that is not finite");
  for (const auto& triangle : mesh.triangles) {
    for (const std::int32_t corner : triangle) {
      if (corner < 0 || corner >= mesh.points_m.cols()) finding("a corner that is no point");
    }
  }
}

void scene_file(const std::string& bytes) {
  const scene::Scene scene = scene::load_scene(folder().file("scenes/input.toml", bytes));
  // What is accepted can be written down and is the same scene when read again.
  const std::string resolved = scene::resolved_toml(scene);
  if (scene::scene_hash(scene::parse_scene(resolved, folder().root() / "scenes/input.toml")) !=
      scene::scene_hash(scene))
    finding("the resolved scene is another one:\n" + resolved);
}

void study_file(const std::string& bytes) { (void)scene::load_study(folder().file("studies/input.toml", bytes)); }
void tuning_file(const std::string& bytes) {
  (void)scene::load_tuning_study(folder().file("studies/input.toml", bytes));
}

void gate_file(const std::string& bytes) { (void)scene::parse_gate_file(bytes, "gates/input.toml"); }
void waiver_file(const std::string& bytes) { (void)scene::load_gate_waivers(folder().file("waivers.toml", bytes)); }

void parameter_file(const std::string& bytes) {
  static const scene::Scene scene = scene::load_scene(source / "meshes/scenes/ball-on-cube-press.toml");
  (void)scene::with_parameters(scene, folder().file("parameters/input.toml", bytes));
}

void track_file(const std::string& bytes) {
  std::vector<scene::Fault> faults;
  std::vector<int> lines;
  const auto rows = scene::read_track_csv(bytes, "track.csv", faults, lines);
  if (!faults.empty()) throw scene::InputError(faults);
  if (rows.size() != lines.size()) finding("a row without its line");
}

/// The whole way of a mesh file: the format, the checks, convexity.
void mesh_file(const char* ending, const std::string& bytes) {
  std::vector<scene::Fault> faults;
  const auto mesh =
      scene::read_triangle_mesh(folder().file(path("tools") / (std::string("input") + ending), bytes), 1e-3, faults);
  if (mesh && faults.empty()) require_finite(*mesh);
  if (!mesh && faults.empty()) finding("no mesh and no fault");
  if (!faults.empty()) throw scene::InputError(faults);
}

void live_log(const std::string& bytes) { (void)live::read_log(folder().file("live.csv", bytes)); }

/// The record of a load step as the store keeps it, on a mesh of one cell; its checksum is taken to be right.
void store_record(const std::string& bytes) {
  reference::Mesh<2> mesh;
  mesh.points_m.setZero(2, reference::Mesh<2>::nodes_per_cell);
  mesh.cells.resize(1);
  (void)reference::from_record<2>(reference::Record(bytes), mesh);
}

/// The same bytes as a file of the store, whose checksum is wrong.
void store_file(const std::string& bytes) {
  static const reference::Store store(folder().root() / "store", "fuzz", [] {});
  std::error_code ignored;
  if (std::FILE* out = std::fopen(store.step_file(1, 1).c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
  (void)store.read(1, 1);
}

void summary_file(const std::string& bytes) { (void)compare::read_figures(folder().file("summary.json", bytes)); }

/// A result folder whose manifest is the input.
void manifest_file(const std::string& bytes) {
  std::filesystem::create_directories(folder().root() / "result");
  (void)folder().file("result/manifest.json", bytes);
  (void)folder().file("result/summary.json", "{\"units\": {}}");
  (void)folder().file("result/curve.csv", "time_s\n0\n");
  (void)compare::read_result_folder(folder().root() / "result");
}

void curve_file(const std::string& bytes) {
  const std::vector<scene::Column> columns = compare::parse_csv(bytes, "curve.csv");
  for (const scene::Column& column : columns) {
    if (column.values.size() != columns.front().values.size()) finding("columns of different length");
  }
}

using Target = void (*)(const std::string& bytes);

const std::map<std::string_view, Target> targets = {
    {"scene", &scene_file},
    {"study", &study_file},
    {"tuning", &tuning_file},
    {"gate", &gate_file},
    {"waiver", &waiver_file},
    {"parameters", &parameter_file},
    {"track", &track_file},
    {"stl", [](const std::string& bytes) { mesh_file(".stl", bytes); }},
    {"obj", [](const std::string& bytes) { mesh_file(".obj", bytes); }},
    {"ply", [](const std::string& bytes) { mesh_file(".ply", bytes); }},
    {"log", &live_log},
    {"record", &store_record},
    {"store", &store_file},
    {"summary", &summary_file},
    {"manifest", &manifest_file},
    {"curve", &curve_file},
};

Target target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view option = "--kind=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(option)) continue;
    const auto found = targets.find(argument.substr(option.size()));
    if (found != targets.end()) target = found->second;
  }
  if (target != nullptr) return 0;
  std::fprintf(stderr, "expected --kind= and one of:");
  for (const auto& [name, function] : targets) std::fprintf(stderr, " %s", std::string(name).c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    target(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const scene::InputError& error) {
    require_readable(error.what());
  }
  return 0;
}
