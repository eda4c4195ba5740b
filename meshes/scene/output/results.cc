#include "scene/output/results.h"

#include "scene/base/build_info.h"
#include "scene/base/json_text.h"
#include "scene/input/scene_io.h"
#include "scene/mesh/mesh_file.h"
#include "scene/model/first_contact.h"

#include <nlohmann/json.hpp>

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <thread>

namespace touchstone::scene {
namespace {

using Json = nlohmann::ordered_json;

/// One column per value of `get`, over all records.
template <class Records, class Get>
Column column(std::string name, const Records& records, Get get) {
  Column out{std::move(name), {}};
  for (const auto& record : records) out.values.push_back(get(record));
  return out;
}

constexpr const char* axis_names[] = {"x", "y", "z"};

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(std::min(line.find(':') + 2, line.size()));
  }
  return "unknown";
}

}  // namespace

std::vector<Column> track_columns(const Instants& records) {
  std::vector<Column> columns;
  columns.push_back(column("time_s", records, [](const InstantRecord& r) { return r.time_s; }));
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(column("tool_" + std::string(axis_names[axis]) + "_m", records,
                             [axis](const InstantRecord& r) { return r.tool.position_m[axis]; }));
  }
  const Eigen::Index order[] = {3, 0, 1, 2};  // Eigen keeps x, y, z, w
  const char* names[] = {"tool_qw", "tool_qx", "tool_qy", "tool_qz"};
  for (int i = 0; i < 4; ++i) {
    columns.push_back(
        column(names[i], records, [at = order[i]](const InstantRecord& r) { return r.tool.orientation.coeffs()[at]; }));
  }
  columns.push_back(column("depth_m", records, [](const InstantRecord& r) { return r.depth_m; }));
  if (std::any_of(records.begin(), records.end(), [](const InstantRecord& r) { return r.separation_m > 0.0; })) {
    columns.push_back(column("separation_m", records, [](const InstantRecord& r) { return r.separation_m; }));
  }
  return columns;
}

std::vector<Column> record_columns(const Instants& records, const std::string& prefix) {
  int regions = 0;
  bool friction = false;
  for (const InstantRecord& record : records) {
    for (const RegionRecord& region : record.regions) {
      regions = std::max(regions, region.id + 1);
      friction = friction || region.sliding || region.friction_n != Vec3::Zero();
    }
  }
  std::vector<Column> columns;
  for (int id = 0; id < regions; ++id) {
    const std::string name = prefix + "region" + std::to_string(id) + "_";
    const auto add = [&](const std::string& quantity, const std::function<double(const RegionRecord&)>& get) {
      columns.push_back(column(name + quantity, records, [&](const InstantRecord& r) {
        const auto region = std::find_if(r.regions.begin(), r.regions.end(), [&](const auto& x) { return x.id == id; });
        return region != r.regions.end() ? get(*region) : 0.0;
      }));
    };
    add("depth_m", [](const RegionRecord& r) { return r.depth_m; });
    for (int axis = 0; axis < 3; ++axis) {
      add("force_" + std::string(axis_names[axis]) + "_n", [axis](const RegionRecord& r) { return r.force_n[axis]; });
    }
    for (int axis = 0; axis < 3; ++axis) {
      add("torque_" + std::string(axis_names[axis]) + "_nm",
          [axis](const RegionRecord& r) { return r.torque_nm[axis]; });
    }
    add("area_m2", [](const RegionRecord& r) { return r.area_m2; });
    if (!friction) continue;
    for (int axis = 0; axis < 3; ++axis) {
      add("friction_" + std::string(axis_names[axis]) + "_n",
          [axis](const RegionRecord& r) { return r.friction_n[axis]; });
    }
    add("sliding", [](const RegionRecord& r) { return r.sliding ? 1.0 : 0.0; });
  }
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(column(prefix + "support_force_" + axis_names[axis] + "_n", records,
                             [axis](const InstantRecord& r) { return r.support_force_n[axis]; }));
  }
  return columns;
}

void write_csv(const std::filesystem::path& path, const std::vector<Column>& columns) {
  std::string text;
  for (const Column& c : columns) text += (text.empty() ? "" : ",") + c.name;
  text += '\n';
  const std::size_t rows = columns.empty() ? 0 : columns.front().values.size();
  char number[32];
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      const double value = columns[i].values.at(row);
      // Without a sign, which NaN may have and not every reader accepts.
      if (std::isnan(value)) {
        text += "nan";
      } else {
        text.append(number, std::to_chars(number, number + sizeof number, value).ptr);
      }
    }
    text += '\n';
  }
  write_file(path, text);
}

const Figure* find_figure(const Figures& figures, std::string_view key) {
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const auto& f) { return f.key == key; });
  return found == figures.end() ? nullptr : &*found;
}

void write_summary(const std::filesystem::path& path, const Figures& figures) {
  Json json;
  Json units, reasons;
  for (const Figure& figure : figures) {
    const bool is_text = !figure.text.empty() && std::isfinite(figure.number);
    json[figure.key] = is_text ? Json(figure.text) : number_or_null(figure.number);
    units[figure.key] = figure.unit;
    if (!is_text && !figure.text.empty()) reasons[figure.key] = figure.text;
  }
  json["units"] = units;
  if (!reasons.is_null()) json["reasons"] = reasons;
  write_file(path, json_text(json));
}

std::string kept_tool_name(const Tool& tool) {
  return content_of_file(tool.mesh) != nullptr ? "tool" + std::filesystem::path(tool.file).extension().string() : "";
}

Manifest make_manifest(const Scene& scene, const std::string& command) {
  utsname host{};
  uname(&host);
  Scene kept = scene;
  const std::string tool_name = kept_tool_name(scene.tool);
  if (!tool_name.empty()) kept.tool.file = tool_name;
  Manifest manifest{command,
                    scene_hash(scene),
                    scene.title.empty() ? scene.name : scene.title,
                    resolved_toml(kept),
                    {{"version", build_info.version},
                     {"commit", build_info.commit},
                     {"compiler", build_info.compiler},
                     {"build", build_info.build_type},
                     {"host", host.nodename},
                     {"system", std::string(host.sysname) + " " + host.release + " " + host.machine},
                     {"processor", processor_name()},
                     {"processors", std::to_string(std::thread::hardware_concurrency())},
                     {"date", utc_now()}},
                    {},
                    tool_name,
                    scene.tool.mesh};
  if (const std::string warning = no_contact_warning(scene); !warning.empty())
    manifest.entries.emplace_back("warning", warning);
  return manifest;
}

void write_manifest(const std::filesystem::path& path, const Manifest& manifest) {
  if (const std::string* content = content_of_file(manifest.tool_mesh)) {
    write_file(path.parent_path() / manifest.tool_name, *content);
  }
  Json json;
  json["command"] = manifest.command;
  json["scene_hash"] = manifest.scene_hash;
  if (!manifest.title.empty()) json["title"] = manifest.title;
  for (const auto& [name, value] : manifest.entries) json[name] = value;
  for (const StageTime& time : manifest.times) {
    json["times"][time.stage] = {{"wall_s", number_or_null(time.wall_s)}, {"cpu_s", number_or_null(time.cpu_s)}};
  }
  json["resolved_scene"] = manifest.resolved_scene;
  write_file(path, json_text(json));
}

FolderLock prepare_result_folder(const std::filesystem::path& folder) {
  require_writable(folder, "--out");
  // Not "lock", which a study's process holds while its command takes this one.
  FolderLock lock(folder, ".touchstone-writer");
  if (!lock.try_take()) {
    throw InputError("--out " + folder.string() +
                     ": another run is writing there; expected a folder of its own, or to be run after it");
  }
  remove_unfinished(folder);
  return lock;
}

}  // namespace touchstone::scene
