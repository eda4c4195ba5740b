// Time of a tick along the track of scenes: step_times PASSES SCENE...
// Of 201 poses each has the least time of the passes. Prints the median, the 99th percentile and the largest [us].
#include "fast/step/cell_rule.h"
#include "fast/step/step.h"
#include "scene/input/scene_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

int main(int count, char** arguments) {
  using namespace touchstone;
  if (count < 3) return 2;
  const int passes = std::stoi(arguments[1]);
  for (int k = 2; k < count; ++k) {
    const scene::Scene scene = scene::load_scene(arguments[k]);
    const fast::FastModel model = fast::model_of(scene);
    const double begin_s = scene.track.front().time_s, length_s = scene.track.back().time_s - begin_s;
    constexpr int poses = 201;
    std::vector<double> least_us(poses, std::numeric_limits<double>::max());
    for (int pass = 0; pass < passes; ++pass) {
      fast::FastState state(model);
      for (std::size_t i = 0; i < least_us.size(); ++i) {
        const scene::Pose pose = scene::pose_at(scene.track, begin_s + length_s * static_cast<double>(i) / (poses - 1));
        const auto begin = std::chrono::steady_clock::now();
        fast::step(model, pose, state);
        const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
        least_us[i] = std::min(least_us[i], took.count());
      }
    }
    std::sort(least_us.begin(), least_us.end());
    fmt::print("{:<28} p50 {:>7.2f}  p99 {:>7.2f}  largest {:>7.2f}",
               std::filesystem::path(arguments[k]).stem().string(), least_us[poses / 2], least_us[poses * 99 / 100],
               least_us.back());
    if (model.cells) fmt::print("  {} points, {:.2f} %", model.cells->rule.points, 100.0 * model.cells->error_rel);
    fmt::print("\n");
    std::fflush(stdout);
  }
}
