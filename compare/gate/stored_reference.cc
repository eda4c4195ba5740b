#include "compare/gate/stored_reference.h"

#include "compare/report/result_folder.h"
#include "reference/run/uncertainty.h"
#include "scene/base/build_info.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/base/hash.h"
#include "scene/base/json_text.h"
#include "scene/base/text.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"

#include <fmt/format.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;
using std::filesystem::path;

constexpr int format = 1;
constexpr const char* about_name = "reference.json";
constexpr const char* curve_name = "curve.csv";
constexpr const char* surface_name = "surface.f32.z";
constexpr const char* axes[] = {"x", "y", "z"};

std::string points_hash(const scene::Surface& surface) {
  return scene::hash_text({reinterpret_cast<const char*>(surface.points_m.data()),
                           static_cast<std::size_t>(surface.points_m.size()) * sizeof(double)});
}

std::string region_column(std::size_t place, const std::string& quantity) {
  return "region" + std::to_string(place) + "_" + quantity;
}

std::string middle_column(std::size_t place) { return "middle" + std::to_string(place) + "_"; }

/// All figures of the instants except track and shape. Unlike scene::record_columns, this keeps the order of the
/// regions: they are numbered by their place in the record.
std::vector<scene::Column> answer_columns(const reference::Result& result) {
  std::size_t most = 0;
  for (const scene::InstantRecord& record : result.instants) most = std::max(most, record.regions.size());
  std::vector<scene::Column> columns;
  const auto add = [&](const std::string& name, const auto& get) {
    scene::Column column{name, {}};
    for (std::size_t t = 0; t < result.instants.size(); ++t) column.values.push_back(get(t));
    columns.push_back(std::move(column));
  };
  add("regions", [&](std::size_t t) { return static_cast<double>(result.instants[t].regions.size()); });
  for (std::size_t k = 0; k < most; ++k) {
    const auto add_of = [&](const std::string& quantity, const auto& get) {
      add(region_column(k, quantity), [&](std::size_t t) {
        return k < result.instants[t].regions.size() ? get(result.instants[t].regions[k]) : 0.0;
      });
    };
    using Region = scene::RegionRecord;
    add_of("id", [](const Region& r) { return static_cast<double>(r.id); });
    add_of("depth_m", [](const Region& r) { return r.depth_m; });
    add_of("area_m2", [](const Region& r) { return r.area_m2; });
    add_of("sliding", [](const Region& r) { return r.sliding ? 1.0 : 0.0; });
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = axes[axis];
      add_of("force_" + name + "_n", [axis](const Region& r) { return r.force_n[axis]; });
      add_of("torque_" + name + "_nm", [axis](const Region& r) { return r.torque_nm[axis]; });
      add_of("friction_" + name + "_n", [axis](const Region& r) { return r.friction_n[axis]; });
    }
  }
  // A region in grazing contact has no centre.
  std::size_t middles = 0;
  for (const auto& instant : result.instants) middles = std::max(middles, instant.region_middles_m.size());
  add("middles", [&](std::size_t t) { return static_cast<double>(result.instants[t].region_middles_m.size()); });
  for (std::size_t k = 0; k < middles; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      add(middle_column(k) + axes[axis] + "_m", [&](std::size_t t) {
        return k < result.instants[t].region_middles_m.size() ? result.instants[t].region_middles_m[k][axis] : 0.0;
      });
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    add(std::string("support_force_") + axes[axis] + "_n",
        [&, axis](std::size_t t) { return result.instants[t].support_force_n[axis]; });
  }
  add("force_uncertainty_n", [&](std::size_t t) { return result.instants[t].force_uncertainty_n; });
  add("residual_penetration_m", [&](std::size_t t) { return result.instants[t].residual_penetration_m; });
  add("between_nodes_penetration_m", [&](std::size_t t) { return result.instants[t].between_nodes_penetration_m; });
  add("equilibrium_rel", [&](std::size_t t) { return result.instants[t].equilibrium_rel; });
  add("volume_change_rel", [&](std::size_t t) { return result.instants[t].volume_change_rel; });
  return columns;
}

/// Reads a file that scene::write_csv wrote.
class Table {
 public:
  Table(std::string_view text, const path& file) {
    try {
      for (scene::Column& column : parse_csv(text, file)) columns_[column.name] = std::move(column.values);
    } catch (const scene::InputError& error) {
      throw UnusableReference(error.what());
    }
  }
  /// The uncertainty; NaN if it is not known.
  [[nodiscard]] double band_at(const std::string& name, std::size_t row) const {
    const auto found = columns_.find(name);
    if (found == columns_.end() || row >= found->second.size() || std::isinf(found->second[row])) {
      throw UnusableReference(fmt::format("column {} is missing, short or not finite", name));
    }
    return found->second[row];
  }
  [[nodiscard]] double at(const std::string& name, std::size_t row) const {
    const double value = band_at(name, row);
    if (std::isnan(value)) throw UnusableReference(fmt::format("column {} is not finite", name));
    return value;
  }
  [[nodiscard]] std::size_t count_at(const std::string& name, std::size_t row) const {
    const double value = at(name, row);
    if (value < 0.0 || value > std::numeric_limits<int>::max() || value != std::floor(value)) {
      throw UnusableReference(fmt::format("column {} holds {}, expected a whole number from 0", name, value));
    }
    return static_cast<std::size_t>(value);
  }
  [[nodiscard]] scene::Vec3 vector_at(const std::string& before, const std::string& after, std::size_t row) const {
    scene::Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = at(before + axes[axis] + after, row);
    return v;
  }
  [[nodiscard]] std::size_t rows(const std::string& name) const {
    const auto found = columns_.find(name);
    return found == columns_.end() ? 0 : found->second.size();
  }

 private:
  std::map<std::string, std::vector<double>> columns_;
};

/// All first bytes of the numbers, then all second bytes and so on: similar bytes next to each other compress better.
std::string shuffled(const std::vector<float>& numbers) {
  const auto* bytes = reinterpret_cast<const char*>(numbers.data());
  std::string out(numbers.size() * sizeof(float), '\0');
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t b = 0; b < sizeof(float); ++b) out[b * numbers.size() + i] = bytes[i * sizeof(float) + b];
  }
  return out;
}

std::vector<float> unshuffled(const std::string& bytes) {
  std::vector<float> numbers(bytes.size() / sizeof(float));
  auto* out = reinterpret_cast<char*>(numbers.data());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t b = 0; b < sizeof(float); ++b) out[i * sizeof(float) + b] = bytes[b * numbers.size() + i];
  }
  return numbers;
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib cannot compress the surface");
  }
  out.resize(size);
  return out;
}

std::string uncompressed(const std::string& bytes, std::size_t expected) {
  uLongf size = expected;
  std::string out(expected, '\0');
  if (uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 bytes.size()) != Z_OK ||
      size != expected) {
    throw UnusableReference(std::string(surface_name) +
                            " does not hold the displacement of every rest point at every instant");
  }
  return out;
}

std::string surface_bytes(const reference::Result& result) {
  std::vector<float> numbers;
  for (std::size_t t = 0; t < result.instants.size(); ++t) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double u_m : result.instants[t].displacement_m.row(axis)) numbers.push_back(static_cast<float>(u_m));
    }
    for (const double band_m : result.instants[t].displacement_uncertainty_m)
      numbers.push_back(static_cast<float>(band_m));
  }
  return compressed(shuffled(numbers));
}

void take_surface(const std::string& bytes, Eigen::Index points, reference::Result& result) {
  const std::size_t numbers_per_instant = 4 * static_cast<std::size_t>(points);
  const std::vector<float> numbers =
      unshuffled(uncompressed(bytes, result.instants.size() * numbers_per_instant * sizeof(float)));
  for (std::size_t t = 0; t < result.instants.size(); ++t) {
    const Eigen::Map<const Eigen::MatrixXf> all(numbers.data() + t * numbers_per_instant, points, 4);
    if (!all.leftCols<3>().allFinite())
      throw UnusableReference(std::string(surface_name) + " holds a displacement that is not finite");
    result.instants[t].displacement_m = all.leftCols<3>().transpose().cast<double>();
    result.instants[t].displacement_uncertainty_m = all.col(3).cast<double>();
  }
}

void take_curve(const Table& table, std::size_t instants, reference::Result& result) {
  if (table.rows("time_s") != instants) {
    throw UnusableReference(
        fmt::format("{} holds {} instants, the scene {}", curve_name, table.rows("time_s"), instants));
  }
  result.instants.resize(instants);
  for (std::size_t t = 0; t < result.instants.size(); ++t) {
    scene::ReferenceInstant& record = result.instants[t];
    record.time_s = table.at("time_s", t);
    record.tool.position_m = table.vector_at("tool_", "_m", t);
    record.tool.orientation = Eigen::Quaterniond(table.at("tool_qw", t), table.at("tool_qx", t), table.at("tool_qy", t),
                                                 table.at("tool_qz", t));
    record.depth_m = table.at("depth_m", t);
    record.support_force_n = table.vector_at("support_force_", "_n", t);
    const std::size_t regions = table.count_at("regions", t);
    for (std::size_t k = 0; k < regions; ++k) {
      const auto of = [&](const std::string& quantity) { return table.at(region_column(k, quantity), t); };
      const auto vector_of = [&](const std::string& quantity, const std::string& unit) {
        return table.vector_at(region_column(k, quantity), unit, t);
      };
      record.regions.push_back({of("depth_m"), vector_of("force_", "_n"), vector_of("torque_", "_nm"), of("area_m2"),
                                static_cast<int>(table.count_at(region_column(k, "id"), t)),
                                vector_of("friction_", "_n"), of("sliding") != 0.0});
    }
    const std::size_t middles = table.count_at("middles", t);
    for (std::size_t k = 0; k < middles; ++k)
      record.region_middles_m.push_back(table.vector_at(middle_column(k), "_m", t));
    record.force_uncertainty_n = table.band_at("force_uncertainty_n", t);
    record.residual_penetration_m = table.band_at("residual_penetration_m", t);
    record.between_nodes_penetration_m = table.band_at("between_nodes_penetration_m", t);
    record.equilibrium_rel = table.band_at("equilibrium_rel", t);
    record.volume_change_rel = table.band_at("volume_change_rel", t);
  }
}

Json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

int count(const Json& json) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > std::numeric_limits<int>::max()) {
    throw UnusableReference("expected a whole number, found " +
                            scene::visible(scene::shortened(scene::json_text(json))));
  }
  return json.get<int>();
}

std::optional<double> number(const Json& json) {
  return json.is_number() ? std::optional(json.get<double>()) : std::nullopt;
}

/// Reads a file of the folder and compares its checksum with the stored one.
std::string checked(const path& file, const std::string& checksum) {
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) throw UnusableReference("missing: " + file.string());
  if (scene::hash_text(*text) != checksum) throw UnusableReference("altered: " + file.string());
  return *text;
}

}  // namespace

void store_reference(const path& folder, const scene::Scene& scene, const scene::Surface& surface,
                     const reference::Result& result, const std::string& command) {
  std::filesystem::create_directories(folder);
  std::vector<scene::Column> columns = scene::track_columns(result.instants);
  for (scene::Column& column : answer_columns(result)) columns.push_back(std::move(column));
  scene::write_csv(folder / curve_name, columns);
  const std::string bytes = surface_bytes(result);
  scene::write_file(folder / surface_name, bytes);
  Json levels = Json::array();
  for (const reference::LevelRecord& level : result.levels) {
    levels.push_back({{"element_size_m", level.element_size_m},
                      {"unknowns", level.unknowns},
                      {"newton_iterations", level.newton_iterations},
                      {"wall_s", level.wall_s},
                      {"cpu_s", level.cpu_s}});
  }
  const Json about = {{"format", format},
                      {"command", command},
                      {"scene", scene.name},
                      {"reference_key", reference::content_key(scene)},
                      {"rest_points", surface.vertex_count()},
                      {"rest_points_hash", points_hash(surface)},
                      {"model", result.model},
                      {"level", result.levels.size()},
                      {"levels", levels},
                      {"force_uncertainty_rel", number_or_null(result.force_uncertainty_rel)},
                      {"shape_uncertainty_rel", number_or_null(result.shape_uncertainty_rel)},
                      {"error_asked", result.refinement.error_asked},
                      {"refinement", result.refinement.why_ended},
                      {"version", scene::build_info.version},
                      {"commit", scene::build_info.commit},
                      {"curve_checksum", scene::hash_text(*scene::read_file(folder / curve_name))},
                      {"surface_checksum", scene::hash_text(bytes)}};
  scene::write_file(folder / about_name, scene::json_text(about));
}

reference::Result stored_reference(const path& folder, const scene::Scene& scene, const scene::Surface& surface) {
  const std::optional<std::string> text = scene::read_file(folder / about_name);
  if (!text) throw UnusableReference("missing: " + (folder / about_name).string());
  reference::Result result;
  std::string curve_checksum, surface_checksum;
  try {
    const Json about = Json::parse(*text);
    if (about.at("format") != format) throw UnusableReference("another format: " + (folder / about_name).string());
    result.key = about.at("reference_key");
    if (const std::string key = reference::content_key(scene); result.key != key) {
      throw UnusableReference(fmt::format("stale: {} is of scene {}, and the scene or the method is now {}",
                                          folder.string(), scene::visible(scene::shortened(result.key)), key));
    }
    if (about.at("rest_points_hash") != points_hash(surface)) {
      throw UnusableReference("stale: " + folder.string() + " is of other rest points than the fast model's");
    }
    result.model = scene::visible(about.at("model").get<std::string>());
    result.force_uncertainty_rel = number(about.at("force_uncertainty_rel"));
    result.shape_uncertainty_rel = number(about.at("shape_uncertainty_rel"));
    result.refinement.error_asked = about.at("error_asked");
    result.refinement.why_ended = scene::visible(about.at("refinement").get<std::string>());
    for (const Json& level : about.at("levels")) {
      reference::LevelRecord& record = result.levels.emplace_back();
      record.element_size_m = level.at("element_size_m");
      record.unknowns = count(level.at("unknowns"));
      record.newton_iterations = count(level.at("newton_iterations"));
      record.wall_s = level.at("wall_s");
      record.cpu_s = level.at("cpu_s");
    }
    curve_checksum = about.at("curve_checksum");
    surface_checksum = about.at("surface_checksum");
  } catch (const Json::exception& error) {
    throw UnusableReference((folder / about_name).string() + ": " + scene::visible(scene::shortened(error.what())));
  }
  const path curve = folder / curve_name;
  take_curve(Table(checked(curve, curve_checksum), curve), scene::instants_s(scene).size(), result);
  take_surface(checked(folder / surface_name, surface_checksum), surface.points_m.cols(), result);
  // Written as null, both if unknown and if not applicable; the instants' uncertainties tell which.
  const auto& all = result.instants;
  if (std::any_of(all.begin(), all.end(), [](const auto& one) { return std::isnan(one.force_uncertainty_n); })) {
    result.force_uncertainty_rel = reference::force_uncertainty_rel(all);
  }
  if (std::any_of(all.begin(), all.end(), [](const auto& one) { return one.displacement_uncertainty_m.hasNaN(); })) {
    result.shape_uncertainty_rel = reference::shape_uncertainty_rel(all, surface.vertex_area_m2);
  }
  result.from_store = true;
  return result;
}

}  // namespace touchstone::compare
