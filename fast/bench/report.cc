#include "fast/bench/report.h"

#include "fast/bench/statistics.h"
#include "fast/step/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::bench {
namespace {

std::string number(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  return fmt::format("{:.{}f}", value, size >= 100.0 ? 0 : size >= 10.0 ? 1 : 2);
}

std::string dotted(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

void add_case(scene::Figures& figures, const CaseResult& c) {
  const std::string key = "bench." + dotted(c.which.name());
  const auto add = [&](const char* name, double value, const char* unit) {
    figures.push_back({key + "." + name, value, "", unit});
  };
  add("triangles", c.triangles, "");
  if (!c.available) {
    figures.push_back({key + ".status", 0.0, c.why, ""});
    return;
  }
  add("vertices", c.vertices, "");
  add("ticks", c.ticks, "");
  add("regions_least", c.regions_least, "");
  add("regions_most", c.regions_most, "");
  add("points", c.points, "");
  add("setup_s", c.setup_s, "s");
  add("memory_bytes", static_cast<double>(c.memory_bytes), "bytes");
  fast::add_figures(key + ".step_us", c.step.wall, figures);
  fast::add_figures(key + ".floor_us", c.floor.wall, figures);
  fast::add_figures(key + ".force_us", c.force, figures);
  add("step_cpu_us", c.step.cpu_us, "us");
  add("floor_cpu_us", c.floor.cpu_us, "us");
  add("over_floor", c.step_over_floor(), "");
  add("over_floor_cpu", ratio(c.step.cpu_us, c.floor.cpu_us), "");
  add("force_us_per_region", c.force_us_per_region(), "us");
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    if (c.stages[s].max_us > 0.0) {
      fast::add_figures(key + ".stage." + fast::stage_names[s] + "_us", c.stages[s], figures);
      add(("stage." + std::string(fast::stage_names[s]) + "_over_floor").c_str(),
          ratio(c.stages[s].p50_us, c.floor.wall.p50_us), "");
    }
  }
  if (std::isfinite(c.instructions)) {
    add("instructions", c.instructions, "");
    add("cycles", c.cycles, "");
  }
  figures.push_back({key + ".status", 0.0, fast::status_text(c.status), ""});
}

void add_peer(scene::Figures& figures, const PeerResult& p) {
  const std::string key = "bench.bullet." + p.size + "." + p.setting.name;
  figures.push_back({key + ".triangles", static_cast<double>(p.triangles), "", ""});
  figures.push_back({key + ".tetrahedra", static_cast<double>(p.tetrahedra), "", ""});
  figures.push_back({key + ".status", 0.0, !p.sound ? "diverged" : !p.touching ? "not in contact" : "in contact", ""});
  if (!p.valid()) return;
  figures.push_back({key + ".ticks", static_cast<double>(p.ticks), "", ""});
  fast::add_figures(key + ".step_us", p.step.wall, figures);
  figures.push_back({key + ".step_cpu_us", p.step.cpu_us, "", "us"});
  figures.push_back({key + ".over_step", p.over_step(), "", ""});
}

std::string case_table(const BenchResult& result) {
  std::vector<std::vector<std::string>> rows = {{"case", "triangles", "regions", "points", "p50", "p99", "p99.9", "max",
                                                 "cpu", "floor", "x floor", "force", "per region"}};
  for (const CaseResult& c : result.cases) {
    if (!c.available) {
      rows.push_back({c.which.name(), std::to_string(c.triangles), c.why});
      continue;
    }
    const std::string regions = std::to_string(c.regions_least) +
                                (c.regions_most == c.regions_least ? "" : "-" + std::to_string(c.regions_most));
    rows.push_back({c.which.name(), std::to_string(c.triangles), regions, std::to_string(c.points),
                    number(c.step.wall.p50_us), number(c.step.wall.p99_us), number(c.step.wall.p999_us),
                    number(c.step.wall.max_us), number(c.step.cpu_us), number(c.floor.wall.p50_us),
                    number(c.step_over_floor()), number(c.force.p50_us), number(c.force_us_per_region())});
  }
  return "Whole step [us], wall clock; cpu: the thread's own time; floor: copying the same output arrays; force: pose "
         "to "
         "force\n" +
         aligned(rows);
}

std::string stage_table(const BenchResult& result) {
  std::vector<std::string> head = {"case"};
  std::vector<std::size_t> shown;
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    if (std::any_of(result.cases.begin(), result.cases.end(),
                    [s](const CaseResult& c) { return c.stages[s].max_us > 0.0; })) {
      head.emplace_back(fast::stage_names[s]);
      shown.push_back(s);
    }
  }
  const bool counted = std::any_of(result.cases.begin(), result.cases.end(),
                                   [](const CaseResult& c) { return std::isfinite(c.instructions); });
  if (counted) head.insert(head.end(), {"instructions", "cycles"});
  std::vector<std::vector<std::string>> rows = {head};
  for (const CaseResult& c : result.cases) {
    if (!c.available) continue;
    std::vector<std::string> row = {c.which.name()};
    for (const std::size_t s : shown) row.push_back(number(c.stages[s].p50_us));
    if (counted) row.insert(row.end(), {number(c.instructions), number(c.cycles)});
    rows.push_back(row);
  }
  return "Stages, median [us]; instructions and cycles of a step: " + result.counters + "\n" + aligned(rows);
}

std::string peer_table(const BenchResult& result) {
  if (result.peer_version.empty()) return "Bullet: not in this build (Debian's libbullet-dev)\n";
  std::vector<std::vector<std::string>> rows = {{"peer", "triangles", "tetrahedra", "p50", "p99", "cpu", "our step",
                                                 "x our step", "dent of depth [mm]", "state"}};
  for (const PeerResult& p : result.peers) {
    const bool valid = p.valid();
    const auto shown = [valid](double value) { return valid ? number(value) : std::string("-"); };
    rows.push_back({p.size + "/" + p.setting.name, std::to_string(p.triangles), std::to_string(p.tetrahedra),
                    shown(p.step.wall.p50_us), shown(p.step.wall.p99_us), shown(p.step.cpu_us), number(p.our_step_us),
                    number(p.over_step()), number(1e3 * p.dent_m) + " of " + number(1e3 * p.depth_m),
                    !p.sound      ? "diverged"
                    : !p.touching ? "not in contact"
                                  : "in contact"});
  }
  return result.peer_version +
         ", deformable neo-Hookean block, steps of 1 ms [us]; rubber: 3 MPa; pvc: 34 kPa (Table I of the paper)\n" +
         aligned(rows, true);
}

/// Stages by their fraction of a case's step, the largest first.
std::string where_time_goes(const CaseResult& c) {
  double sum_us = 0.0;
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    sum_us += c.stages[s].p50_us;
    if (c.stages[s].max_us > 0.0) order.push_back(s);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return c.stages[a].p50_us > c.stages[b].p50_us; });
  std::string text = "  " + c.which.name() + ":";
  for (const std::size_t s : order) {
    text += fmt::format(" {} {} us ({:.0f} %, {} floors){}", fast::stage_names[s], number(c.stages[s].p50_us),
                        100.0 * c.stages[s].p50_us / sum_us, number(ratio(c.stages[s].p50_us, c.floor.wall.p50_us)),
                        s == order.back() ? "" : ",");
  }
  if (std::isfinite(c.instructions)) {
    text += fmt::format("; {} instructions in {} cycles, {} per vertex", number(c.instructions), number(c.cycles),
                        number(c.instructions / c.vertices));
  }
  return text + "\n";
}

/// Cases whose stages explain a figure.
std::vector<std::string> cases_behind(const std::string& key) {
  if (key == "step_over_floor_100k") return {"box/100k/1"};
  if (key == "bullet_over_step_1k") return {"box/1k/1"};
  if (key == "step_over_floor_4k") return {"box/4k/1"};
  if (key == "response_step_us_p50_4k" || key == "response_force_us_p50_4k") return {"response/4k/1"};
  if (key == "response_step_us_p50_100k") return {"response/100k/1"};
  return {"box/4k/1", "box/4k/10"};
}

std::string verdict_text(const BenchResult& result) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> behind;
  for (const Verdict& v : verdicts(result)) {
    rows.push_back({v.key, v.measured() ? number(v.number) + (v.unit.empty() ? "" : " " + v.unit) : "-",
                    std::string(v.at_most ? "<= " : ">= ") + number(v.target),
                    !v.measured() ? "not measured"
                    : v.met()     ? "met"
                                  : "missed",
                    v.what});
    if (!v.measured() || v.met()) continue;
    for (const std::string& name : cases_behind(v.key)) {
      if (std::find(behind.begin(), behind.end(), name) == behind.end()) behind.push_back(name);
    }
  }
  std::string text = "Targets\n" + aligned(rows, true);
  if (!behind.empty()) text += "Stages of the cases that missed their target\n";
  for (const std::string& name : behind) {
    if (const CaseResult* c = result.find(name)) text += where_time_goes(*c);
  }
  return text;
}

std::string remarks(const BenchResult& result) {
  std::string text;
  for (const CaseResult& c : result.cases) {
    if (!c.available || c.as_planned()) continue;
    text += fmt::format("  {}: {} to {} regions pressed, {}\n", c.which.name(), c.regions_least, c.regions_most,
                        fast::status_text(c.status));
  }
  return text.empty() ? "" : "Cases that differ from the plan\n" + text;
}

}  // namespace

const CaseResult* BenchResult::find(const std::string& name) const {
  const auto found = std::find_if(cases.begin(), cases.end(),
                                  [&](const CaseResult& c) { return c.available && c.which.name() == name; });
  return found == cases.end() ? nullptr : &*found;
}

bool Verdict::measured() const noexcept { return std::isfinite(number); }

bool Verdict::met() const noexcept { return measured() && (at_most ? number <= target : number >= target); }

std::vector<Verdict> verdicts(const BenchResult& result) {
  const auto over_floor = [&](const char* name) {
    const CaseResult* c = result.find(name);
    return c != nullptr ? c->step_over_floor() : not_measured;
  };
  const CaseResult *one = result.find("box/4k/1"), *ten = result.find("box/4k/10");
  const double ten_over_one = one != nullptr && ten != nullptr && ten->regions_least == ten->which.regions
                                  ? ratio(ten->step.wall.p50_us, one->step.wall.p50_us)
                                  : not_measured;
  double force_us = not_measured;
  for (const CaseResult& c : result.cases) {
    if (matches(c.which.name(), "box/4k")) force_us = std::fmax(force_us, c.force_us_per_region());
  }
  const auto response_us = [&](const char* name, bool force) {
    const CaseResult* c = result.find(name);
    return c == nullptr ? not_measured : force ? c->force.p50_us : c->step.wall.p50_us;
  };
  const PeerResult* peer = fastest(result.peers, "1k", "rubber");
  return {
      {"step_over_floor_4k", over_floor("box/4k/1"), 10.0, true, "", "whole step over its floor, one region"},
      {"step_over_floor_100k", over_floor("box/100k/1"), 3.0, true, "", "the same at 100k triangles"},
      {"ten_regions_over_one_4k", ten_over_one, 6.0, true, "", "whole step with ten regions over that with one"},
      {"force_us_p50_per_region", force_us, 10.0, true, "us", "pose to force, the worst of 4k (paper: 30 us)"},
      {"response_step_us_p50_4k", response_us("response/4k/1", false), 30.0, true, "us", "response model, whole step"},
      {"response_force_us_p50_4k", response_us("response/4k/1", true), 10.0, true, "us", "the same, pose to force"},
      {"response_step_us_p50_100k", response_us("response/100k/1", false), 1000.0, true, "us",
       "the same at 100k triangles: a tick of 1 ms"},
      {"bullet_over_step_1k", peer != nullptr ? peer->over_step() : not_measured, 50.0, false, "",
       peer != nullptr ? "Bullet's step, " + peer->setting.name + ", over ours" : "Bullet's step over ours"}};
}

scene::Figures figures(const BenchResult& result) {
  scene::Figures figures;
  for (const Verdict& v : verdicts(result)) figures.push_back({v.key, v.number, "", v.unit});
  for (const Verdict& v : verdicts(result)) {
    figures.push_back({"bench.target." + v.key, v.target, "", v.unit});
    figures.push_back({"bench.verdict." + v.key, 0.0, !v.measured() ? "not measured" : v.met() ? "met" : "missed", ""});
  }
  figures.push_back({"bench.counters", 0.0, result.counters, ""});
  figures.push_back({"bench.peer", 0.0, result.peer_version.empty() ? "none in this build" : result.peer_version, ""});
  if (const PeerResult* soft = fastest(result.peers, "1k", "")) {
    figures.push_back({"bench.bullet.1k.fastest_over_step", soft->over_step(), "", ""});
  }
  for (const CaseResult& c : result.cases) add_case(figures, c);
  for (const PeerResult& p : result.peers) add_peer(figures, p);
  return figures;
}

std::string report_text(const BenchResult& result) {
  std::string text;
  if (!result.cases.empty()) text += case_table(result) + "\n" + stage_table(result) + "\n";
  if (result.peer_version.empty() || !result.peers.empty()) text += peer_table(result) + "\n";
  return text + verdict_text(result) + remarks(result);
}

std::string aligned(const std::vector<std::vector<std::string>>& rows, bool words) {
  std::size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, row.size());
  std::vector<std::size_t> width(columns, 0);
  for (const auto& row : rows) {
    // A short row ends in a sentence, which may extend over the missing columns.
    const std::size_t fitted = row.size() < columns ? row.size() - 1 : columns;
    for (std::size_t i = 0; i < fitted; ++i) width[i] = std::max(width[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string gap(width[i] > row[i].size() ? width[i] - row[i].size() : 0, ' ');
      const bool last = i + 1 == row.size();
      const bool left = i == 0 || (last && (words || row.size() < columns));
      text += "  " + (left ? row[i] + (last ? "" : gap) : gap + row[i]);
    }
    text += "\n";
  }
  return text;
}

}  // namespace touchstone::bench
