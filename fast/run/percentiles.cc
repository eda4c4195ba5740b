#include "fast/run/percentiles.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

double at_rank(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

}  // namespace

double percentile_us(std::vector<double> sample_us, double part) {
  std::sort(sample_us.begin(), sample_us.end());
  return at_rank(sample_us, part);
}

Percentiles percentiles(std::vector<double> sample_us) {
  std::sort(sample_us.begin(), sample_us.end());
  return {at_rank(sample_us, 0.5), at_rank(sample_us, 0.99), at_rank(sample_us, 0.999), at_rank(sample_us, 1.0)};
}

void add_figures(const std::string& key, const Percentiles& percentiles, scene::Figures& figures) {
  figures.push_back({key + ".p50", percentiles.p50_us, "", "us"});
  figures.push_back({key + ".p99", percentiles.p99_us, "", "us"});
  figures.push_back({key + ".p999", percentiles.p999_us, "", "us"});
  figures.push_back({key + ".max", percentiles.max_us, "", "us"});
}

}  // namespace touchstone::fast
