#include "fast/live/history.h"

#include <algorithm>

namespace touchstone::live {

void RunHistory::add(const TickRecord& record) {
  while (record.tick.index / length_ >= static_cast<std::int64_t>(most_intervals)) {
    for (std::size_t i = 0; i < intervals_.size(); i += 2) {
      Interval joined = intervals_[i];
      if (i + 1 < intervals_.size()) {
        const Interval& next = intervals_[i + 1];
        joined.ticks += next.ticks;
        joined.missed += next.missed;
        joined.force_max_n = std::max(joined.force_max_n, next.force_max_n);
        joined.model_force_max_n = std::max(joined.model_force_max_n, next.model_force_max_n);
      }
      intervals_[i / 2] = joined;
    }
    intervals_.resize((intervals_.size() + 1) / 2);
    length_ *= 2;
  }
  const auto at = static_cast<std::size_t>(record.tick.index / length_);
  if (at >= intervals_.size()) intervals_.resize(at + 1);
  Interval& interval = intervals_[at];
  ++interval.ticks;
  interval.missed += (record.tick.index - next_index_) - (record.sequence - next_sequence_);
  interval.force_max_n = std::max(interval.force_max_n, record.published.force_n.norm());
  interval.model_force_max_n = std::max(interval.model_force_max_n, record.model.force_n.norm());
  next_index_ = record.tick.index + 1;
  next_sequence_ = record.sequence + 1;
}

}  // namespace touchstone::live
