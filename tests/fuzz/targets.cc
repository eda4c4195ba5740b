// One fuzz target for each kind of file that Touchstone reads. libFuzzer calls LLVMFuzzerTestOneInput with the bytes
// of a file; `--kind=NAME` on the command line says of which kind, and `--seed=FILE` writes there what the fuzzer would
// not find by itself: a valid file of a kind that has checksums. A reader may accept the bytes or refuse them with its
// own error, whose text must be fit for a terminal. Anything else ends the process, and that is a finding.
#include "compare/gate/stored_reference.h"
#include "compare/input/gate_file.h"
#include "compare/input/study_file.h"
#include "compare/input/tuning_study.h"
#include "compare/report/result_folder.h"
#include "fast/live/live_log.h"
#include "reference/run/step_record.h"
#include "reference/run/store.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/base/hash.h"
#include "scene/base/text.h"
#include "scene/input/scene_io.h"
#include "scene/input/track_csv.h"
#include "scene/mesh/mesh_file.h"
#include "scene/mesh/mesh_formats.h"
#include "scene/mesh/triangle_mesh.h"
#include "scene/shape/surface.h"
#include "support/source_folder.h"

#include <unistd.h>
#include <zlib.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

/// Made by the reference solver from everything that affects its result; here the same for any scene.
std::string touchstone::reference::content_key(const scene::Scene&) { return "any"; }

namespace {

using namespace touchstone;
using std::filesystem::path;

const path source = source_folder();

[[noreturn]] void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

/// A folder in memory with the shipped scenes, tools and studies, to which the input is added as a file. Removed at the
/// end of the process.
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
  /// Writes the input to a file of this name.
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

/// Checks that a message is text for a terminal, of a readable length. @returns it
const std::string& require_readable(const std::string& message) {
  constexpr std::size_t bytes_max = 64 << 10;
  if (message.empty() || message.size() > bytes_max)
    finding("a message of " + std::to_string(message.size()) + " bytes");
  for (std::string_view rest = message; !rest.empty();) {
    const std::size_t length = scene::utf8_length(rest);
    if (length == 0) finding("a message that is not UTF-8");
    if (rest[0] != '\n' && scene::is_control(rest, length)) finding("a control character in a message");
    rest.remove_prefix(length);
  }
  return message;
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
  // An accepted scene can be written and gives the same scene when read again.
  const std::string resolved = scene::resolved_toml(scene);
  if (scene::scene_hash(scene::parse_scene(resolved, folder().root() / "scenes/input.toml")) !=
      scene::scene_hash(scene))
    finding("the resolved scene is another one:\n" + resolved);
}

void study_file(const std::string& bytes) { (void)compare::load_study(folder().file("studies/input.toml", bytes)); }
void tuning_file(const std::string& bytes) {
  (void)compare::load_tuning_study(folder().file("studies/input.toml", bytes));
}

void gate_file(const std::string& bytes) { (void)compare::parse_gate_file(bytes, "gates/input.toml"); }
void waiver_file(const std::string& bytes) { (void)compare::load_gate_waivers(folder().file("waivers.toml", bytes)); }

void parameter_file(const std::string& bytes) {
  static const scene::Scene scene = scene::load_scene(source / "meshes/scenes/ball-on-cube-press.toml");
  (void)compare::with_parameters(scene, folder().file("parameters/input.toml", bytes));
}

void track_file(const std::string& bytes) {
  std::vector<scene::Fault> faults;
  std::vector<int> lines;
  const auto rows = scene::read_track_csv(bytes, "track.csv", faults, lines);
  if (!faults.empty()) throw scene::InputError(faults);
  if (rows.size() != lines.size()) finding("a row without its line");
}

/// All stages of a mesh file: the format, the checks, convexity.
void mesh_file(const char* ending, const std::string& bytes) {
  std::vector<scene::Fault> faults;
  const auto mesh =
      scene::read_triangle_mesh(folder().file(path("tools") / (std::string("input") + ending), bytes), 1e-3, faults);
  if (mesh && faults.empty()) require_finite(*mesh);
  if (!mesh && faults.empty()) finding("no mesh and no fault");
  if (!faults.empty()) throw scene::InputError(faults);
}

void live_log(const std::string& bytes) { (void)live::read_log(folder().file("live.csv", bytes)); }

/// The record of a load step as the store keeps it, on a mesh of one cell; its checksum is assumed to be right.
void store_record(const std::string& bytes) {
  reference::Mesh<2> mesh;
  mesh.points_m.setZero(2, reference::Mesh<2>::nodes_per_cell);
  mesh.cells.resize(1);
  (void)reference::from_record<2>(bytes, mesh);
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

/// The scene of a gate, with few rest points.
struct GateScene {
  scene::Scene scene;
  scene::Surface rest;
};
const GateScene& gate_scene() {
  static const GateScene one = [] {
    scene::Scene scene = scene::load_scene(source / "meshes/scenes/ball-on-cube-press.toml",
                                           {"fast.triangles=12", "compare.instants=2"});
    scene::Surface rest = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
    return GateScene{std::move(scene), std::move(rest)};
  }();
  return one;
}

/// A result with a contact at the second instant.
reference::Result pressed(Eigen::Index points) {
  reference::Result result;
  for (int t = 0; t < 2; ++t) {
    scene::ReferenceInstant& record = result.instants.emplace_back();
    record.time_s = t;
    record.displacement_m = Eigen::Matrix3Xd::Constant(3, points, 1e-3 * t);
    if (t == 1) {
      record.depth_m = 1e-3;
      record.regions.push_back({1e-3, scene::Vec3(0, 0, 1), scene::Vec3::Zero(), 1e-5, 0, scene::Vec3::Zero(), false});
      record.region_middles_m.emplace_back(0.0, 0.0, 0.06);
    }
    record.displacement_uncertainty_m.setConstant(points, 1e-6);
    record.force_uncertainty_n = record.residual_penetration_m = record.between_nodes_penetration_m = 1e-6;
    record.equilibrium_rel = record.volume_change_rel = 1e-6;
  }
  result.model = "axisymmetric";
  result.levels.emplace_back();
  return result;
}

/// Committed reference data of two instants, for a gate. One of its three files is the input; the checksums are right.
void committed_reference(const std::string& about, const std::string& curve, const std::string& surface) {
  std::filesystem::create_directories(folder().root() / "reference");
  (void)folder().file("reference/reference.json", about);
  (void)folder().file("reference/curve.csv", curve);
  (void)folder().file("reference/surface.f32.z", surface);
  const auto& [scene, rest] = gate_scene();
  try {
    const reference::Result result = compare::stored_reference(folder().root() / "reference", scene, rest);
    (void)require_readable(result.model + result.refinement.why_ended + ".");
    if (result.instants.size() != 2) finding("another number of instants than the scene's");
    for (const scene::InstantRecord& instant : result.instants) {
      if (instant.displacement_m.cols() != rest.points_m.cols()) finding("a point without its displacement");
      if (!instant.displacement_m.allFinite()) finding("a displacement that is not finite");
      for (const scene::RegionRecord& region : instant.regions) {
        if (!region.force_n.allFinite() || region.id < 0) finding("a region that is none");
      }
    }
  } catch (const compare::UnusableReference& error) {
    throw scene::InputError(require_readable(error.what()));
  }
}

/// A file of a valid reference.
const std::string& valid(const std::string& name) {
  static const std::map<std::string, std::string> files = [] {
    const path where = folder().root() / "valid";
    const auto& [scene, rest] = gate_scene();
    compare::store_reference(where, scene, rest, pressed(rest.points_m.cols()), "fuzz");
    std::map<std::string, std::string> read;
    for (const char* file : {"reference.json", "curve.csv", "surface.f32.z"}) {
      read[file] = *scene::read_file(where / file);
    }
    return read;
  }();
  return files.at(name);
}

/// The reference's manifest, with the checksum of another file in place of a valid one's.
std::string about_with(const char* name, const std::string& bytes) {
  std::string about = valid("reference.json");
  const std::string checksum = scene::hash_text(valid(name));
  return about.replace(about.find(checksum), checksum.size(), scene::hash_text(bytes));
}

void reference_about(const std::string& bytes) {
  committed_reference(bytes, valid("curve.csv"), valid("surface.f32.z"));
}
void reference_curve(const std::string& bytes) {
  committed_reference(about_with("curve.csv", bytes), bytes, valid("surface.f32.z"));
}
/// The bytes as they are, or as the numbers that are compressed in the file.
void reference_surface(const std::string& bytes) {
  std::string file = bytes;
  if (bytes.starts_with("numbers")) {
    const auto& [scene, rest] = gate_scene();
    std::string numbers = bytes.substr(7);
    numbers.resize(2 * 4 * sizeof(float) * static_cast<std::size_t>(rest.points_m.cols()));
    uLongf size = compressBound(numbers.size());
    file.resize(size);
    (void)compress(reinterpret_cast<Bytef*>(file.data()), &size, reinterpret_cast<const Bytef*>(numbers.data()),
                   numbers.size());
    file.resize(size);
  }
  committed_reference(about_with("surface.f32.z", file), valid("curve.csv"), file);
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
    {"reference", &reference_about},
    {"reference-curve", &reference_curve},
    {"reference-surface", &reference_surface},
    {"summary", &summary_file},
    {"manifest", &manifest_file},
    {"curve", &curve_file},
};

/// Seeds that the target makes by itself.
const std::map<std::string_view, std::string (*)()> seeds = {
    {"reference", [] { return valid("reference.json"); }},
    {"reference-curve", [] { return valid("curve.csv"); }},
    {"reference-surface", [] { return valid("surface.f32.z"); }},
};

Target target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  std::map<std::string, std::string> options;
  for (int i = 1; i < *argc; ++i) {
    const std::string argument = (*argv)[i];
    const std::size_t equals = argument.find('=');
    if (equals != std::string::npos) options[argument.substr(0, equals)] = argument.substr(equals + 1);
  }
  const std::string kind = options["--kind"];
  if (const auto found = targets.find(kind); found != targets.end()) target = found->second;
  if (const auto seed = seeds.find(kind); seed != seeds.end() && options.contains("--seed")) {
    scene::write_file(options["--seed"], seed->second());
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
