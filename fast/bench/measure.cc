#include "fast/bench/measure.h"

#include "fast/bench/floor.h"
#include "fast/bench/statistics.h"
#include "fast/response/response_engine.h"
#include "fast/step/skeleton_engine.h"
#include "scene/base/index.h"
#include "scene/base/stopwatch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <utility>
#include <vector>

namespace touchstone::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Unmeasured ticks at the start of every block: they reload the caches after the other kind of work.
constexpr int warming_ticks = 2;

/// All measurements per tick; memory is allocated before the first one.
struct Samples {
  std::vector<double> step_us, force_us, floor_us;
  std::array<std::vector<double>, fast::stage_count> stage_us;
  std::vector<double> step_cpu_us, floor_cpu_us, instructions, cycles;  ///< mean of each block
};

std::unique_ptr<fast::Engine> engine_of(const Case& which) {
  const scene::Scene scene = scene_of(which);
  if (!which.response) return std::make_unique<fast::SkeletonEngine>(scene);
  scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  scene::Response response = made_up_response(scene, surface);
  return std::make_unique<fast::ResponseEngine>(scene, std::move(surface), std::move(response));
}

class Measurement {
 public:
  Measurement(const Case& which, fast::Engine& engine, HardwareCounters& counters)
      : which_(which),
        engine_(engine),
        skeleton_(dynamic_cast<const fast::SkeletonEngine*>(&engine)),
        floor_(engine.field()),
        counters_(counters) {}

  /// Presses the tool in. @returns the time of a step [us]
  double approach() {
    while (tick_ < approach_ticks) engine_.step(next_pose());
    constexpr int trial = 9;
    std::vector<double> step_us;
    for (int i = 0; i < trial; ++i) {
      step_us.push_back(1e-3 * static_cast<double>(engine_.step_timed(next_pose()).step_ns));
    }
    return fast::percentile_us(std::move(step_us), 0.5);
  }

  void step_block(int ticks, CaseResult& result) {
    for (int i = 0; i < warming_ticks; ++i) engine_.step(next_pose());
    // Poses are computed in advance: computing them is not part of the step.
    poses_.clear();
    for (int i = 0; i < ticks; ++i) poses_.push_back(next_pose());
    counters_.start();
    const double cpu_begin_us = thread_cpu_us();
    for (const scene::Pose& pose : poses_) {
      const fast::TimedStep timed = engine_.step_timed(pose);
      samples_.step_us.push_back(1e-3 * static_cast<double>(timed.step_ns));
      samples_.force_us.push_back(1e-3 * static_cast<double>(timed.force_ns));
      result.status |= static_cast<std::uint32_t>(timed.status);
      count_regions(result);
    }
    const double cpu_us = thread_cpu_us() - cpu_begin_us;
    const HardwareCounters::Counts counts = counters_.stop();
    samples_.step_cpu_us.push_back(cpu_us / ticks);
    if (counters_.counting()) {
      samples_.instructions.push_back(counts.instructions / ticks);
      samples_.cycles.push_back(counts.cycles / ticks);
    }
  }

  void floor_block(int ticks) {
    for (int i = 0; i < warming_ticks; ++i) floor_.copy();
    const double cpu_begin_us = thread_cpu_us();
    for (int i = 0; i < ticks; ++i) {
      const Clock::time_point begin = Clock::now();
      floor_.copy();
      samples_.floor_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    }
    samples_.floor_cpu_us.push_back((thread_cpu_us() - cpu_begin_us) / ticks);
  }

  void stage_block(int ticks) {
    for (int i = 0; i < warming_ticks; ++i) engine_.step(next_pose());
    engine_.time_stages(true);
    for (int i = 0; i < ticks; ++i) {
      engine_.step(next_pose());
      for (std::size_t s = 0; s < fast::stage_count; ++s) {
        samples_.stage_us[s].push_back(engine_.stages().spent_us(static_cast<fast::Stage>(s)));
      }
    }
    engine_.time_stages(false);
  }

  void reserve(int ticks) {
    const auto n = static_cast<std::size_t>(ticks);
    for (std::vector<double>* sample : {&samples_.step_us, &samples_.force_us, &samples_.floor_us}) sample->reserve(n);
    for (std::vector<double>& sample : samples_.stage_us) sample.reserve(n);
    poses_.reserve(n);
  }

  void finish(CaseResult& result) {
    result.ticks = static_cast<int>(samples_.step_us.size());
    result.step = {fast::percentiles(std::move(samples_.step_us)), median(std::move(samples_.step_cpu_us))};
    result.floor = {fast::percentiles(std::move(samples_.floor_us)), median(std::move(samples_.floor_cpu_us))};
    result.force = fast::percentiles(std::move(samples_.force_us));
    for (std::size_t s = 0; s < fast::stage_count; ++s) {
      result.stages[s] = fast::percentiles(std::move(samples_.stage_us[s]));
    }
    result.instructions = median(std::move(samples_.instructions));
    result.cycles = median(std::move(samples_.cycles));
    if (skeleton_ == nullptr) return;
    const fast::FastState& state = skeleton_->state();
    for (int i = 0; i < state.region_count; ++i) result.points += nth(state.regions, i).points.count;
  }

 private:
  scene::Pose next_pose() { return pose_at_tick(which_, tick_++); }

  void count_regions(CaseResult& result) const {
    int pressing = engine_.region_count();
    if (skeleton_ != nullptr) {
      const auto& regions = skeleton_->state().regions;
      pressing = static_cast<int>(std::count_if(regions.begin(), regions.begin() + pressing,
                                                [](const fast::ContactRegion& r) { return r.pressing(); }));
    }
    result.regions_least = std::min(result.regions_least, pressing);
    result.regions_most = std::max(result.regions_most, pressing);
  }

  const Case& which_;
  fast::Engine& engine_;
  const fast::SkeletonEngine* skeleton_;  // null for the response model
  CopyFloor floor_;
  HardwareCounters& counters_;
  Samples samples_;
  std::vector<scene::Pose> poses_;
  std::int64_t tick_ = 0;
};

}  // namespace

Effort effort_of(bool quick, int ticks) {
  Effort effort;
  if (quick) {
    effort.seconds_per_case = 0.25;
    effort.ticks_min = 160;
  }
  effort.ticks = ticks;
  return effort;
}

double thread_cpu_us() noexcept {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

double CaseResult::step_over_floor() const noexcept {
  return available ? ratio(step.wall.p50_us, floor.wall.p50_us) : not_measured;
}

double CaseResult::force_us_per_region() const noexcept {
  return available && regions_least > 0 ? force.p50_us / regions_least : not_measured;
}

bool CaseResult::as_planned() const noexcept {
  return available && regions_least == which.regions && regions_most == which.regions && status == 0;
}

CaseResult measure(const Case& which, const Effort& effort, HardwareCounters& counters) {
  CaseResult result;
  result.which = which;
  const scene::Stopwatch watch;
  const std::unique_ptr<fast::Engine> engine = engine_of(which);
  result.setup_s = watch.wall_s();
  result.triangles = engine->surface().triangle_count();
  result.vertices = engine->surface().vertex_count();
  result.memory_bytes = engine->memory_bytes();
  const auto* skeleton = dynamic_cast<const fast::SkeletonEngine*>(engine.get());
  if (skeleton != nullptr && skeleton->model().tool.count() == 0) {
    result.available = false;
    result.why = "not available in this build: the tool has no samples";
    return result;
  }
  Measurement measurement(which, *engine, counters);
  const double step_us = measurement.approach();
  // Two steps per tick, and the copying of the output, which takes a fraction of a step.
  const double wished = 1e6 * effort.seconds_per_case / (2.3 * std::max(step_us, 0.1));
  const int ticks = effort.ticks > 0 ? effort.ticks
                                     : static_cast<int>(std::clamp<double>(wished, effort.ticks_min, effort.ticks_max));
  measurement.reserve(ticks);
  result.regions_least = which.regions;
  for (int done = 0; done < ticks; done += effort.block_ticks) {
    const int block = std::min(effort.block_ticks, ticks - done);
    measurement.step_block(block, result);
    measurement.floor_block(block);
    measurement.stage_block(block);
  }
  measurement.finish(result);
  return result;
}

}  // namespace touchstone::bench
