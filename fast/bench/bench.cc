#include "fast/bench/bench.h"

#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

namespace touchstone::bench {
namespace {

std::string peer_name(const std::string& size, const PeerSetting& setting) {
  return "bullet/" + size + "/" + setting.name;
}

bool chosen(const std::string& name, const std::string& only) { return only.empty() || matches(name, only); }

}  // namespace

std::vector<std::string> peer_sizes(bool quick) {
  return quick ? std::vector<std::string>{"1k"} : std::vector<std::string>{"1k", "4k"};
}

BenchResult run_bench(const BenchOptions& options, const std::function<void(const std::string&)>& progress) {
  const auto report = [&](const std::string& text) {
    if (progress) progress(text);
  };
  std::vector<Case> cases;
  std::vector<std::string> known;  // what may stand behind --only
  const auto meets = [&](const std::string& name) {
    for (std::size_t end = 0; end != std::string::npos;) known.push_back(name.substr(0, end = name.find('/', end + 1)));
    return chosen(name, options.only);
  };
  // A case that is named need not be on the quick list.
  for (const Case& which : all_cases(options.quick && options.only.empty())) {
    if (meets(which.name())) cases.push_back(which);
  }
  bool peer_chosen = false;
  for (const std::string& size : peer_sizes(options.quick)) {
    for (const PeerSetting& setting : peer_settings()) peer_chosen = meets(peer_name(size, setting)) || peer_chosen;
  }
  if (cases.empty() && !peer_chosen) {
    throw scene::InputError("--only " + options.only +
                            ": no such case; expected the first parts of a name such as box/4k/10, ellipsoid/100k/1 or "
                            "bullet/1k/rubber.implicit, with * for any part" +
                            scene::did_you_mean(options.only, known));
  }
  HardwareCounters counters;
  BenchResult result;
  result.counters = counters.state();
  result.peer_version = peer_version();
  const Effort effort = effort_of(options.quick, options.ticks);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    report("bench: " + cases[i].name() + " (" + std::to_string(i + 1) + " of " + std::to_string(cases.size()) + ")");
    result.cases.push_back(measure(cases[i], effort, counters));
  }
  std::vector<PeerSetting> settings = peer_settings();
  for (const std::string& size : peer_sizes(options.quick)) {
    std::vector<PeerSetting> here;
    for (const PeerSetting& setting : settings) {
      if (chosen(peer_name(size, setting), options.only)) here.push_back(setting);
    }
    const std::vector<PeerResult> measured = measure_peer(size, here, options.quick, report);
    // A setting that failed on a coarse mesh is not tried on a finer one.
    std::erase_if(settings, [&](const PeerSetting& setting) {
      return std::any_of(measured.begin(), measured.end(),
                         [&](const PeerResult& peer) { return peer.setting.name == setting.name && !peer.valid(); });
    });
    result.peers.insert(result.peers.end(), measured.begin(), measured.end());
  }
  return result;
}

}  // namespace touchstone::bench
