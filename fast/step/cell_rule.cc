#include "fast/step/cell_rule.h"

#include "fast/step/step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace touchstone::fast {
namespace {

constexpr std::array points_tried{CellRule{}.points, 64, 96, 128, 192, 256, 384, 512, 768, 1024};
/// Poses of the track, evenly spaced in time, and those in contact that are then looked at, at most.
constexpr int poses_tried = 64;
constexpr std::size_t poses_kept = 8;
/// Poses of the track whose halves are made at set-up, evenly spaced in time.
constexpr int poses_halved = 256;
/// A load below this share of the track's largest may change as much as that one.
constexpr double small_load_rel = 0.2;

/// All rounds together make several times as many cells as the last one, which may have twice as many as are asked for.
CellRule rule_of(int points) { return {.points = points, .room = std::max(1024, points * 16)}; }
/// Their load is taken for the limit. The last two rounds make most of them.
constexpr CellRule limit_rule{.points = 512, .halvings = 2, .room = 20000};

/// What the law makes the force of, over all regions.
struct Load {
  double linear_m = 0.0;  ///< mean depths, by the mass shares
  double cubic_m3 = 0.0;  ///< means of the depths' third powers
};

Load load_of(const FastState& state) {
  Load load;
  for (std::size_t k = 0; k < static_cast<std::size_t>(state.region_count); ++k) {
    const ContactRegion& region = state.regions[k];
    if (!region.pressing()) continue;
    load.linear_m += region_load(DuffingLaw(1.0, 0.0), region.points).force_n;
    load.cubic_m3 += region_load(DuffingLaw(0.0, 1.0), region.points).force_n;
  }
  return load;
}

/// So soft that no region deforms the body where another one is.
scene::Contact soft_law() {
  scene::Contact contact;
  contact.k1_n_per_m = 1e-6;
  contact.k3_n_per_m3 = 0.0;
  return contact;
}

/// A model without friction and with that law while this lives.
class Softened {
 public:
  explicit Softened(FastModel& model)
      : model_(model), cells_(model.cells), law_(model.law), resolve_friction_(model.formulas.resolve_friction) {
    model.law = ContactLaw(soft_law());
    model.formulas.resolve_friction = nullptr;
  }
  ~Softened() {
    model_.cells = cells_;
    model_.law = law_;
    model_.formulas.resolve_friction = resolve_friction_;
  }
  Softened(const Softened&) = delete;
  Softened& operator=(const Softened&) = delete;

  /// Leaves the halves that these poses ask for in `halves`.
  std::vector<Load> loads(const CellRule& rule, const std::vector<scene::Pose>& poses) {
    model_.cells = ContactCells{rule, {}};
    FastState state(model_);
    std::vector<Load> loads;
    for (const scene::Pose& pose : poses) {
      step_force(model_, pose, state);
      loads.push_back(load_of(state));
    }
    halves = std::move(state.cells.halves);
    return loads;
  }

  CellHalves halves;

 private:
  FastModel& model_;
  std::optional<ContactCells> cells_;
  ContactLaw law_;
  ResolveFriction resolve_friction_;
};

std::vector<scene::Pose> poses_on(const std::vector<scene::Waypoint>& track, int count) {
  std::vector<scene::Pose> poses;
  if (track.empty()) return poses;
  const double begin_s = track.front().time_s, length_s = track.back().time_s - begin_s;
  for (int k = 0; k < count; ++k) poses.push_back(scene::pose_at(track, begin_s + length_s * k / (count - 1)));
  return poses;
}

/// Some of them that are in contact.
std::vector<scene::Pose> poses_in_contact(const std::vector<scene::Pose>& all, Softened& model) {
  std::vector<scene::Pose> touching, kept;
  const std::vector<Load> loads = model.loads(rule_of(points_tried[0]), all);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (loads[k].linear_m > 0.0) touching.push_back(all[k]);
  }
  const std::size_t count = std::min(poses_kept, touching.size());
  for (std::size_t k = 1; k <= count; ++k) kept.push_back(touching[k * touching.size() / count - 1]);
  return kept;
}

double error_rel(const std::vector<Load>& loads, const std::vector<Load>& limit) {
  double most_m = 0.0, most_m3 = 0.0, most = 0.0;
  for (const Load& load : limit) {
    most_m = std::max(most_m, load.linear_m);
    most_m3 = std::max(most_m3, load.cubic_m3);
  }
  for (std::size_t i = 0; i < limit.size(); ++i) {
    const Load &a = loads[i], &b = limit[i];
    const double floor_m = std::max(b.linear_m, small_load_rel * most_m),
                 floor_m3 = std::max(b.cubic_m3, small_load_rel * most_m3);
    if (floor_m > 0.0) most = std::max(most, std::abs(a.linear_m - b.linear_m) / floor_m);
    // The third power changes more; it is a part of the force.
    if (floor_m3 > 0.0) most = std::max(most, 0.5 * std::abs(a.cubic_m3 - b.cubic_m3) / floor_m3);
  }
  return most;
}

}  // namespace

ContactCells choose_cells(const std::vector<scene::Waypoint>& track, FastModel& model) {
  Softened softened(model);
  const std::vector<scene::Pose> poses = poses_in_contact(poses_on(track, poses_tried), softened);
  ContactCells chosen{rule_of(points_tried[0]), softened.halves};
  if (poses.empty()) return chosen;
  const std::vector<Load> limit = softened.loads(limit_rule, poses);
  for (const int points : points_tried) {
    chosen.rule = rule_of(points);
    chosen.error_rel = error_rel(softened.loads(chosen.rule, poses), limit);
    if (chosen.error_rel <= cell_tolerance_rel) break;
  }
  softened.loads(chosen.rule, poses_on(track, poses_halved));
  chosen.halves = std::move(softened.halves);
  return chosen;
}

FastModel model_of(const scene::Scene& scene) {
  FastModel model(scene);
  if (model.cells) model.cells = choose_cells(scene.track, model);
  return model;
}

}  // namespace touchstone::fast
