#include "fast/live/device_loop.h"

#include "fast/realtime/flush_tiny_numbers.h"

#include <algorithm>
#include <limits>

namespace touchstone::live {
namespace {

scene::Pose no_pose() noexcept {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {scene::Vec3(nan, nan, nan), Eigen::Quaterniond(nan, nan, nan, nan)};
}

void publish_shape(const TickRecord& record, std::int64_t now_ns, const fast::SurfaceField& field,
                   TripleBuffer<ShapeFrame>& shapes) noexcept {
  ShapeFrame& back = shapes.back();
  back.tick = record.tick.index;
  back.stamp_ns = now_ns;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::copy(field.displacement_m[axis].begin(), field.displacement_m[axis].end(),
              back.field.displacement_m[axis].begin());
    std::copy(field.normal[axis].begin(), field.normal[axis].end(), back.field.normal[axis].begin());
  }
  shapes.publish();
}

/// One tick. @param begin_ns time at which the loop woke
void do_tick(const Tick& tick, std::int64_t begin_ns, std::int64_t lateness_ns, const LoopPorts& ports,
             Ledger& ledger) noexcept {
  TickRecord record;
  record.sequence = ledger.ticks;
  record.tick = tick;
  record.lateness_ns = lateness_ns;

  DeviceSample sample;
  record.pose = ports.device.read(tick, sample) ? sample.pose : no_pose();
  record.buttons = sample.buttons;
  fast::StepStatus status = ports.engine.step_force(record.pose);
  const bool good = status != fast::StepStatus::not_finite;
  record.model = ports.engine.wrench();
  record.published = ports.limiter.next(record.model, good);
  ports.device.write(record.published);
  const std::int64_t published_ns = ports.clock.now_ns();

  if (good) status |= ports.engine.step_shape();
  // Published in every tick, even if nothing moved, so that the shape's age is that of its tick.
  if (ports.shapes != nullptr) publish_shape(record, ports.clock.now_ns(), ports.engine.field(), *ports.shapes);
  const std::int64_t shaped_ns = ports.clock.now_ns();

  record.status = static_cast<std::uint32_t>(status);
  if (!good) record.flags |= bad_pose;
  if (ports.limiter.limited()) record.flags |= limited;
  record.force_ns = published_ns - begin_ns;
  record.shape_ns = shaped_ns - published_ns;
  if (ports.listener != nullptr) ports.listener->tick_done(record);
  if (ports.records != nullptr) ports.records->push(record);

  const double force_n = record.published.force_n.norm();
  ++ledger.ticks;
  ledger.bad_poses += good ? 0 : 1;
  ledger.limited_ticks += ports.limiter.limited() ? 1 : 0;
  ledger.force_max_n = std::max(ledger.force_max_n, force_n);
  ledger.model_force_max_n = std::max(ledger.model_force_max_n, record.model.force_n.norm());
  ledger.status |= record.status;
  ledger.force.add(record.force_ns);
  ledger.shape.add(record.shape_ns);
  for (std::size_t s = 0; good && s < fast::stage_count; ++s) {
    const std::int64_t spent_ns = ports.engine.stages().spent_ns(static_cast<fast::Stage>(s));
    if (spent_ns > 0) ledger.stages[s].add(spent_ns);
  }
  if (ports.progress != nullptr) {
    ports.progress->ticks.store(ledger.ticks, std::memory_order_relaxed);
    ports.progress->missed.store(ledger.missed, std::memory_order_relaxed);
    ports.progress->force_n.store(force_n, std::memory_order_relaxed);
  }
  ledger.step.add(ports.clock.now_ns() - begin_ns);
}

/// Index of the last grid point that has passed.
std::int64_t newest_grid_point(const LoopTime& time, std::int64_t since_start_ns) noexcept {
  const std::int64_t seconds = since_start_ns / second_ns, rest_ns = since_start_ns % second_ns;
  std::int64_t index = seconds * time.rate_hz + rest_ns * time.rate_hz / second_ns;
  // Grid points are whole nanoseconds, rounded down.
  while (time.time_ns(index + 1) <= since_start_ns) ++index;
  return index;
}

/// Fades the force out at the end of the run, at the limited rate: the wrench has no jump.
void fade_out(const LoopTime& time, const LoopPorts& ports) noexcept {
  constexpr double longest_s = 10.0;
  const std::int64_t begin_ns = ports.clock.now_ns();
  for (std::int64_t k = 1; time.time_s(k) < longest_s; ++k) {
    const Wrench& wrench = ports.limiter.next(Wrench{}, false);
    if (wrench.force_n.isZero(0.0) && wrench.torque_nm.isZero(0.0)) break;
    ports.device.write(wrench);
    ports.clock.wait_until(begin_ns + time.time_ns(k));
  }
  ports.device.write(Wrench{});
}

}  // namespace

void run_device_loop(const LoopTime& time, const LoopPorts& ports, Ledger& ledger) noexcept {
  [[maybe_unused]] const fast::FlushTinyNumbers flush;
  ports.engine.time_stages(true);
  // Start one period ahead, so that the first tick is on time.
  const std::int64_t start_ns = ports.clock.now_ns() + time.time_ns(1);
  for (std::int64_t index = 0; index < time.grid_points && ledger.ticks < time.ticks;) {
    if (ports.stop != nullptr && ports.stop->load(std::memory_order_relaxed)) break;
    ports.clock.wait_until(start_ns + time.time_ns(index));
    const std::int64_t now_ns = ports.clock.now_ns();
    ledger.lateness.add(now_ns - (start_ns + time.time_ns(index)));
    const std::int64_t newest = std::min(newest_grid_point(time, now_ns - start_ns), time.grid_points);
    ledger.missed += newest - index;
    index = newest;
    if (index == time.grid_points) break;
    do_tick({index, time.time_s(index)}, now_ns, now_ns - (start_ns + time.time_ns(index)), ports, ledger);
    ++index;
  }
  fade_out(time, ports);
}

}  // namespace touchstone::live
