#include "compare/calculix/time_to_error.h"

#include "compare/calculix/calculix.h"
#include "compare/format/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::compare {
namespace {

constexpr int finer_levels = 2;

/// @param force_n, exact_n  one per instant
double largest_error(const std::vector<double>& force_n, const std::vector<double>& exact_n) {
  double largest_n = 0.0;
  for (std::size_t i = 0; i < exact_n.size(); ++i) largest_n = std::max(largest_n, std::abs(force_n[i] - exact_n[i]));
  return largest_n / *std::max_element(exact_n.begin(), exact_n.end());
}

/// Wall and CPU time of every level of one solve, read when the progress reports the next level.
class LevelWatch {
 public:
  explicit LevelWatch(int levels) : times_(levels) {}
  void at(int level) {
    if (level == level_) return;
    stop();
    level_ = level;
    watch_ = {};
  }
  void stop() {
    if (level_ > 0) times_[level_ - 1] = watch_.read("level");
  }
  [[nodiscard]] const scene::StageTime& of(int level) const { return times_[level]; }

 private:
  int level_ = 0;  // from 1, as in the progress
  scene::Stopwatch watch_;
  std::vector<scene::StageTime> times_;
};

Curve curve(const std::string& name, Look look, const std::vector<MeshCost>& meshes) {
  Curve curve{name, look, {}, {}};
  for (const MeshCost& mesh : meshes) {
    curve.x.push_back(mesh.cpu_s);
    curve.y.push_back(100.0 * mesh.error);
  }
  return curve;
}

}  // namespace

std::optional<MeshCost> cost_within(const std::vector<MeshCost>& meshes, double error) {
  std::optional<MeshCost> first;
  for (auto mesh = meshes.rbegin(); mesh != meshes.rend() && mesh->error <= error; ++mesh) first = *mesh;
  return first;
}

TimeToError time_to_error(const scene::Scene& scene, int meshes, const std::filesystem::path& folder) {
  const std::filesystem::path store = folder / "store";
  std::filesystem::remove_all(store);
  scene::Scene finer = scene;
  finer.reference.levels = meshes + finer_levels;
  LevelWatch watch(meshes + finer_levels);
  reference::Options options;
  options.store = store;
  options.progress = [&](const reference::Progress& progress) { watch.at(progress.level); };
  const reference::Result result = reference::solve(finer, Eigen::Matrix3Xd(3, 0), options);
  watch.stop();
  std::filesystem::remove_all(store);
  if (static_cast<int>(result.levels.size()) < meshes + finer_levels) {
    throw scene::InputError("--time-to-error: " + result.refinement.why_ended);
  }

  TimeToError times;
  const std::vector<double>& exact_n = result.levels.back().force_n;
  double wall_s = 0.0, cpu_s = 0.0;  // each mesh starts from the coarser one's solution, so times add up
  for (int level = 0; level < meshes; ++level) {
    const double error = largest_error(result.levels[level].force_n, exact_n);
    wall_s += watch.of(level).wall_s;
    cpu_s += watch.of(level).cpu_s;
    times.ours.push_back({level, error, wall_s, cpu_s});
    const reference::Deck deck = reference::calculix_deck(scene, {.level = level});
    const std::string name = fmt::format("mesh-{}", level + 1);
    scene::write_file(folder / (name + ".inp"), deck.text);
    const CalculixRun run = run_calculix(folder, name, deck);
    if (run.steps.size() < deck.instants.size()) continue;
    std::vector<double> force_n(exact_n.size());
    for (std::size_t step = 0; step < run.steps.size(); ++step) {
      force_n[deck.instants[step]] = run.steps[step].force_n.norm();
    }
    times.calculix.push_back({level, largest_error(force_n, exact_n), run.wall_s, run.cpu_s});
  }
  return times;
}

std::string time_to_error_text(const TimeToError& times) {
  std::string text;
  for (const auto& [name, meshes] : {std::pair("ours", &times.ours), std::pair("CalculiX", &times.calculix)}) {
    for (const MeshCost& mesh : *meshes) {
      text += fmt::format("{:9} mesh {}: force error {:7.3f} %, CPU {:8.2f} s, wall {:8.2f} s\n", name, mesh.level + 1,
                          100.0 * mesh.error, mesh.cpu_s, mesh.wall_s);
    }
  }
  for (const double error : {0.01, 0.005}) {
    const auto ours = cost_within(times.ours, error), theirs = cost_within(times.calculix, error);
    text += fmt::format("within {} %: ", 100.0 * error);
    if (ours && theirs) {
      text += fmt::format("ours {:.2f} s, CalculiX {:.2f} s of CPU, {:.1f} times as much\n", ours->cpu_s, theirs->cpu_s,
                          theirs->cpu_s / ours->cpu_s);
    } else {
      text += std::string(ours ? "CalculiX" : "ours") + " does not reach it on these meshes\n";
    }
  }
  return text;
}

std::string time_to_error_svg(const TimeToError& times, const std::string& title) {
  Plot plot;
  plot.title = title;
  plot.x_label = "CPU time [s]";
  plot.y_label = "largest force error [% of the largest force]";
  plot.x_log = plot.y_log = true;
  plot.curves = {curve("Touchstone's reference", Look::reference, times.ours),
                 curve("CalculiX 2.20", Look::plain, times.calculix)};
  return as_file(to_svg(plot));
}

std::vector<scene::Column> time_to_error_columns(const TimeToError& times) {
  std::vector<scene::Column> columns{
      {"calculix", {}}, {"mesh", {}}, {"force_error", {}}, {"wall_s", {}}, {"cpu_s", {}}};
  for (const auto& [code, meshes] : {std::pair(0, &times.ours), std::pair(1, &times.calculix)}) {
    for (const MeshCost& mesh : *meshes) {
      const double row[] = {static_cast<double>(code), static_cast<double>(mesh.level + 1), mesh.error, mesh.wall_s,
                            mesh.cpu_s};
      for (std::size_t k = 0; k < columns.size(); ++k) columns[k].values.push_back(row[k]);
    }
  }
  return columns;
}

}  // namespace touchstone::compare
