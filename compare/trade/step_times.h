// Step times of all models, measured in alternating blocks.
#pragma once

#include "compare/model/model.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace touchstone::compare {

/// Poses of the ticks in contact, repeatedly forwards and backwards, so that no step jumps.
class Poses {
 public:
  /// @throws scene::InputError when the track is never in contact or takes more than a million ticks
  explicit Poses(const scene::Scene& scene);
  [[nodiscard]] const scene::Pose& at(std::size_t step) const {
    const std::size_t n = poses_.size(), k = step % (2 * n);
    return poses_[k < n ? k : 2 * n - 1 - k];
  }
  [[nodiscard]] std::size_t round_trip() const { return 2 * poses_.size(); }

 private:
  static constexpr std::int64_t ticks_max = 1'000'000;
  std::vector<scene::Pose> poses_;
};

/// A model whose steps are measured.
struct Timed {
  std::size_t row = 0;  ///< of the caller's
  std::shared_ptr<ContactModel> model;
  std::size_t next = 0;  ///< pose
  std::size_t block = 32;
  std::vector<double> step_us{};
};

/// Times the models in alternating blocks, so that clock drift affects all; each covers the track in both directions.
/// The first steps of a block are not timed: they refill the caches.
void measure_by_turns(std::vector<Timed>& models, const Poses& poses, std::size_t rounds);

}  // namespace touchstone::compare
