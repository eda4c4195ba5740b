#include "compare/app/verify_verb.h"

#include "compare/format/page.h"
#include "compare/format/text.h"
#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"
#include "reference/solver.h"
#include "scene/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace touchstone::compare {
namespace {

using verification::Check;
using verification::Problem;

/// The problems that were named, in the order of `all`.
std::vector<const Problem*> chosen(const std::vector<Problem>& all, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::any_of(all, [&](const Problem& problem) { return problem.name == name; })) continue;
    std::string known;
    for (const Problem& problem : all) known += (known.empty() ? "" : ", ") + problem.name;
    throw scene::InputError("verify: no problem has the name \"" + name + "\"; expected some of " + known);
  }
  std::vector<const Problem*> list;
  for (const Problem& problem : all) {
    if (names.empty() || std::ranges::find(names, problem.name) != names.end()) list.push_back(&problem);
  }
  return list;
}

/// A ratio in percent, or as a power of ten if the percentage would show only zeros.
std::string share_text(double share, bool sign) {
  if (std::isfinite(share) && share != 0.0 && std::abs(share) < 5e-6) {
    return sign ? fmt::format("{:+.0e}", share) : fmt::format("{:.0e}", share);
  }
  return sign ? fmt::format("{:+.3f} %", 100.0 * share) : fmt::format("{:.3g} %", 100.0 * share);
}

/// Cells of a check in both tables, the column headings, and the column widths of the text table.
std::array<std::string, 8> cells_of(const Check& check) {
  return {check.what,
          fmt::format("{:.6g}", check.target),
          fmt::format("{:.6g}", check.value) + (check.unit.empty() ? "" : " " + check.unit),
          share_text(check.error(), true),
          share_text(check.limit, false),
          check.mesh_band ? share_text(*check.mesh_band, false) : "",
          check.order ? fmt::format("{:.1f}", *check.order) : "",
          check.passes() ? "pass" : "MISS"};
}
constexpr std::array<const char*, 8> columns{"check", "target", "value", "error", "limit", "mesh +-", "order", ""};
constexpr std::array<int, 8> widths{46, 12, 15, 9, 6, 8, 5, 4};

template <class Row>
std::string line_of(const Row& row) {
  std::string line = "  ";
  for (std::size_t k = 0; k < columns.size(); ++k) {
    line += k == 0 ? fmt::format("{:<{}}", row[k], widths[k]) : fmt::format(" {:>{}}", row[k], widths[k]);
  }
  return line + "\n";
}

int checks_missed(const ProblemRecord& record) {
  return static_cast<int>(std::ranges::count_if(record.findings.checks, [](const Check& c) { return !c.passes(); }));
}

std::string conclusion(const std::vector<ProblemRecord>& records) {
  const auto missed = std::ranges::count_if(records, [](const ProblemRecord& r) { return !r.passes(); });
  std::size_t checks = 0;
  for (const ProblemRecord& record : records) checks += record.findings.checks.size();
  if (missed == 0) return fmt::format("All {} problems pass, {} checks.", records.size(), checks);
  std::string names;
  for (const ProblemRecord& record : records) {
    if (!record.passes()) names += (names.empty() ? "" : ", ") + record.name;
  }
  return fmt::format("{} of {} problems miss: {}.", missed, records.size(), names);
}

constexpr const char* legend =
    "error: value over target - 1, or absolute where the target is 0. mesh +-: the uncertainty of the finest mesh, "
    "from the last three, whose cell sizes halve. order: of their differences; absent where they "
    "change sign, as a contact force's do when the contact's edge moves by whole nodes.";

/// Makes "nu = 0.3, force" a part of a key: "nu_0.3_force".
std::string key_of(const std::string& what) {
  std::string key;
  for (const char c : what) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.';
    if (plain) {
      key += c;
    } else if (!key.empty() && key.back() != '_') {
      key += '_';
    }
  }
  return key;
}

}  // namespace

bool ProblemRecord::passes() const {
  return failure.empty() && !findings.checks.empty() && std::ranges::all_of(findings.checks, &Check::passes);
}

std::vector<ProblemRecord> run_problems(const std::vector<Problem>& all, const VerifyOptions& options) {
  std::vector<ProblemRecord> records;
  fast::ProgressLine line(options.quiet);
  for (const Problem* problem : chosen(all, options.names)) {
    ProblemRecord& record = records.emplace_back();
    record.name = problem->name;
    record.title = problem->title;
    record.source = problem->source;
    const scene::Stopwatch watch;
    verification::Effort effort;
    effort.quick = options.quick;
    effort.working = [&](const std::string& text) { line.show(problem->name + ": " + text); };
    effort.tell("begins");
    try {
      record.findings = problem->run(effort);
    } catch (const reference::NotConverged& failure) {
      record.failure = failure.what();
    }
    record.time = watch.read(problem->name);
    line.show(fmt::format("{}: {} ({:.1f} s)", record.name, record.passes() ? "pass" : "MISS", record.time.wall_s),
              true);
    line.finish();
  }
  return records;
}

std::string verify_text(const std::vector<ProblemRecord>& records) {
  std::string text;
  for (const ProblemRecord& record : records) {
    text += fmt::format("{}: {} [{}] {:.1f} s\n", record.name, record.title, record.source, record.time.wall_s);
    if (!record.failure.empty()) {
      text += "  MISS, no answer: " + record.failure + "\n\n";
      continue;
    }
    text += line_of(columns);
    for (const Check& check : record.findings.checks) text += line_of(cells_of(check));
    for (const std::string& note : record.findings.notes) text += wrapped("  " + note, 116) + "\n";
    text += "\n";
  }
  return text + wrapped(legend, 116) + "\n" + conclusion(records) + "\n";
}

scene::Figures verify_figures(const std::vector<ProblemRecord>& records) {
  scene::Figures figures;
  const auto missed = std::ranges::count_if(records, [](const ProblemRecord& r) { return !r.passes(); });
  figures.push_back({"verify.problems", static_cast<double>(records.size()), "", ""});
  figures.push_back({"verify.missed", static_cast<double>(missed), "", ""});
  for (const ProblemRecord& record : records) {
    const std::string problem = "verify." + record.name;
    figures.push_back({problem + ".verdict", 0.0, record.passes() ? "pass" : "miss", ""});
    figures.push_back({problem + ".checks_missed", static_cast<double>(checks_missed(record)), "", ""});
    if (!record.failure.empty()) figures.push_back({problem + ".failure", 0.0, record.failure, ""});
    for (const Check& check : record.findings.checks) {
      const std::string key = problem + "." + key_of(check.what) + ".";
      figures.push_back({key + "target", check.target, "", check.unit});
      figures.push_back({key + "value", check.value, "", check.unit});
      figures.push_back({key + "error_rel", check.error(), "", ""});
      figures.push_back({key + "limit_rel", check.limit, "", ""});
      if (check.mesh_band) figures.push_back({key + "mesh_band_rel", *check.mesh_band, "", ""});
      if (check.order) figures.push_back({key + "order", *check.order, "", ""});
    }
  }
  return figures;
}

std::string verify_html(const std::vector<ProblemRecord>& records, const scene::Manifest& manifest) {
  const std::string title = "The reference against closed forms and published benchmarks";
  std::string out = tag("h1", title) + "\n<div class=\"verdict\">" + tag("p", conclusion(records)) + "</div>\n" +
                    tag("p", legend, "class=\"dim\"") + "\n";
  for (const ProblemRecord& record : records) {
    out += tag("h2", record.name) + "\n" + tag("p", record.title + " [" + record.source + "]") + "\n";
    if (!record.failure.empty()) {
      out += tag("p", "MISS, no answer: " + record.failure) + "\n";
      continue;
    }
    out += "<div class=\"scroll\"><table>\n<tr>";
    for (std::size_t k = 0; k < columns.size(); ++k) out += tag("th", columns[k], k == 0 ? "" : "class=\"n\"");
    out += "</tr>\n";
    for (const Check& check : record.findings.checks) {
      out += "<tr>";
      const auto row = cells_of(check);
      for (std::size_t k = 0; k < row.size(); ++k) out += k == 0 ? cell(row[k]) : number_cell(row[k]);
      out += "</tr>\n";
    }
    out += "</table></div>\n";
    for (const std::string& note : record.findings.notes) out += tag("p", note, "class=\"dim\"") + "\n";
  }
  out += tag("h2", "How this was made") + "\n<div class=\"scroll\"><table>\n" + origin_rows(manifest);
  return page(title, out + "</table></div>\n");
}

int verify(const VerifyOptions& options, const std::string& command, const std::vector<Problem>& all) {
  if (options.list) {
    for (const Problem& problem : all) {
      std::cout << fmt::format("{:<20}{} [{}]\n", problem.name, problem.title, problem.source);
    }
    return fast::done;
  }
  static_cast<void>(chosen(all, options.names));
  const scene::FolderLock lock = scene::prepare_result_folder(options.out);
  scene::Manifest manifest = scene::make_manifest(scene::Scene{}, command);
  manifest.scene_hash = "none: the problems are the program's own";
  manifest.resolved_scene.clear();
  manifest.entries.emplace_back("effort", options.quick ? "quick" : "full");
  const std::vector<ProblemRecord> records = run_problems(all, options);
  for (const ProblemRecord& record : records) manifest.times.push_back(record.time);
  const std::string text = verify_text(records);
  scene::write_file(options.out / "table.txt", text);
  scene::write_file(options.out / "report.html", verify_html(records, manifest));
  scene::write_summary(options.out / "summary.json", verify_figures(records));
  scene::write_manifest(options.out / "manifest.json", manifest);
  std::cout << text << "Report: " << (options.out / "report.html").string() << '\n';
  return std::ranges::all_of(records, &ProblemRecord::passes) ? fast::done : fast::answer_is_no;
}

void add_verify_verb(fast::Command& program, VerifyOptions& options) {
  fast::Command verb =
      program.add("verify", "check the reference against closed forms and published benchmarks; exit 1 on a miss");
  verb.option("NAME", options.names, "problems to run (default all)");
  verb.flag("--quick", options.quick, "about a minute: one mesh fewer, without the most expensive cases");
  verb.flag("--list", options.list, "print names and sources of the problems; nothing is run");
  verb.option("--out", options.out, "result folder").shows_default();
  verb.flag("--quiet", options.quiet, "no progress, only results and errors");
  verb.example("verify hertz sneddon --quick");
  verb.action([&options, name = program.program_name()] { return verify(options, name + " verify"); });
}

}  // namespace touchstone::compare
