#include "fast/state.h"

namespace touchstone::fast {

FastState::FastState(const FastModel& model)
    : points(model.tool.count()), ends(model.skeleton.anchor_m.size()), field(model.rest) {}

std::size_t FastState::memory_bytes() const noexcept {
  return sizeof(FastState) + points.memory_bytes() + field.memory_bytes() +
         2 * ends.force_n.size() * sizeof(scene::Vec3);
}

}  // namespace touchstone::fast
