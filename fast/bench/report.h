// Results of the benchmark: targets met or missed, the figures, the table.
#pragma once

#include "fast/bench/measure.h"
#include "fast/bench/peer.h"
#include "scene/output/figures.h"

#include <string>
#include <vector>

namespace touchstone::bench {

struct BenchResult {
  std::vector<CaseResult> cases;
  std::vector<PeerResult> peers;
  std::string peer_version;  ///< empty: built without
  std::string counters;      ///< HardwareCounters::state()

  /// Null where the case was not run or could not be.
  [[nodiscard]] const CaseResult* find(const std::string& name) const;
};

/// A figure the design promises.
struct Verdict {
  std::string key;      ///< of summary.json
  double number = 0.0;  ///< NaN: not measured
  double target = 0.0;
  bool at_most = true;  ///< else at least
  std::string unit;
  std::string what;  ///< in words

  [[nodiscard]] bool measured() const noexcept;
  [[nodiscard]] bool met() const noexcept;
};

/// The five targets of the design, from medians by the wall clock.
/// step_over_floor_4k, step_over_floor_100k: box, one region. ten_regions_over_one_4k: box. force_us_p50_per_region:
/// box of 4k, the worst of the numbers of regions that were run. bullet_over_step_1k: the scene's rubber, the fastest
/// of Bullet's schemes that computed it.
[[nodiscard]] std::vector<Verdict> verdicts(const BenchResult& result);

/// Everything by stable dotted key: the targets' keys, then `bench.<body>.<size>.<regions>.<figure>`.
[[nodiscard]] scene::Figures figures(const BenchResult& result);

/// Cases by columns, the stages' medians, the other simulator, the targets, and the stages of cases that missed one.
[[nodiscard]] std::string report_text(const BenchResult& result);

/// Rows of cells as aligned columns: the first to the left, the others to the right.
/// @param words the last column holds words and is left-aligned as well
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& rows, bool words = false);

}  // namespace touchstone::bench
