// The benchmark as one run.
#pragma once

#include "fast/bench/report.h"

#include <functional>
#include <string>

namespace touchstone::bench {

struct BenchOptions {
  bool quick = false;
  std::string only;  ///< pattern of matches(); empty: everything. Bullet's names are "bullet/1k/rubber.implicit"
  int ticks = 0;     ///< per case; 0: by the time
};

/// Sizes at which Bullet is measured.
[[nodiscard]] std::vector<std::string> peer_sizes(bool quick);

/// @param progress called with a line before each case; may be empty
/// @throws scene::InputError where `only` matches nothing
[[nodiscard]] BenchResult run_bench(const BenchOptions& options,
                                    const std::function<void(const std::string&)>& progress = {});

}  // namespace touchstone::bench
