#include "compare/gate/gate_page.h"

#include "compare/errors/figures.h"
#include "compare/format/page.h"
#include "compare/format/text.h"
#include "compare/gate/gate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::compare {
namespace {

constexpr const char* style = R"(<style>
:root { --holds: #2e7d4f; --broken: #c0392b; }
@media screen and (prefers-color-scheme: dark) { :root { --holds: #63c78f; --broken: #ff7b6b; } }
.holds { color: var(--holds); } .broken { color: var(--broken); } .gates td { min-width: 9em; } .gates details { font-size: .88rem; }
.gates summary { font-weight: 400; color: var(--dim); } .gates p { margin: .2rem 0; } .gates svg { max-width: 22rem; width: 100%; height: 14px; }
.gates .mark { fill: var(--ink); } .gates .group .under { font-weight: 400; font-size: .88rem; }
.gates .under { font-variant-numeric: tabular-nums; }
</style>
)";

/// A number in the gate's unit, with four digits so that it differs visibly from its limit.
std::string in_unit(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "no number";
  if (unit.empty()) {
    const bool round_off = std::abs(value) < least_ratio;
    return round_off ? percent_text(value) : fmt::format("{:.4g}{}%", 100.0 * value, no_break);
  }
  return fmt::format("{:.4g}{}{}", value, no_break, unit);
}

std::string margin_text(const GateRecord& record) {
  const double held = record.held(), limit = record.gate.limit;
  if (!std::isfinite(held)) return "no number";
  return record.within() ? fmt::format("{:.0f}{}% of the limit left", 100.0 * (1.0 - held / limit), no_break)
                         : fmt::format("{:.3g} times the limit", held / limit);
}

/// Bar of the checked value over the limit. The limit is marked; a longer bar is cut off at 5/4 of it.
std::string bar(const GateRecord& record) {
  constexpr double limit_px = 240.0, whole_px = 300.0;
  const double held = record.held();
  const auto px = [&](double value) { return std::clamp(value / record.gate.limit * limit_px, 0.0, whole_px); };
  std::string out = fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} 14\" preserveAspectRatio=\"none\" role=\"img\" class=\"{1}\"><title>{2}</title>"
      "<rect x=\"0\" y=\"5\" width=\"{3:.0f}\" height=\"4\" fill=\"currentColor\" opacity=\"0.18\"/>",
      whole_px, record.passes() ? "holds" : "broken", escape_xml(margin_text(record)), limit_px);
  if (std::isfinite(held)) {
    const bool truth = record.gate.kind == GateKind::truth;
    const double value_px = truth ? px(std::abs(*record.value)) : px(held);
    out += fmt::format("<rect x=\"0\" y=\"2\" width=\"{:.2f}\" height=\"10\" fill=\"currentColor\"/>", value_px);
    if (truth) {
      out += fmt::format(
          "<rect x=\"{:.2f}\" y=\"2\" width=\"{:.2f}\" height=\"10\" fill=\"currentColor\" opacity=\"0.45\"/>",
          value_px, px(held) - value_px);
    }
  }
  return out +
         fmt::format("<rect x=\"{:.1f}\" y=\"0\" width=\"2\" height=\"14\" class=\"mark\"/></svg>", limit_px - 1.0);
}

/// The checked value as a sentence.
std::string held_text(const GateRecord& record) {
  const std::string& unit = record.gate.unit;
  if (!record.value) return "no number";
  if (record.gate.kind == GateKind::drift) {
    return fmt::format("{}, {} from the accepted {}; at most {}", in_unit(*record.value, unit),
                       in_unit(record.held(), unit), in_unit(record.accepted.value_or(NAN), unit),
                       in_unit(record.gate.limit, unit));
  }
  return fmt::format("{}, uncertain by {}; together at most {}", in_unit(*record.value, unit),
                     in_unit(record.uncertainty.value_or(NAN), unit), in_unit(record.gate.limit, unit));
}

std::string link(const std::filesystem::path& file, const std::filesystem::path& out) {
  const std::filesystem::path to = std::filesystem::absolute(file).lexically_normal(),
                              from = std::filesystem::absolute(out).lexically_normal();
  return tag("a", file.generic_string(), "href=\"" + escape_xml(to.lexically_relative(from).generic_string()) + "\"");
}

std::string anchor(const GateRecord& record) { return "gate-" + record.name(); }

std::string head(const std::vector<GateRecord>& records, const std::vector<std::string>& faults,
                 const std::vector<GateProof>& proofs) {
  const auto red = std::ranges::count_if(records, [](const GateRecord& r) { return !r.passes(); });
  const bool good = red == 0 && faults.empty();
  const std::string failed =
      fmt::format(", but the run failed: {} fault{}", faults.size(), faults.size() == 1 ? "" : "s");
  std::string out = tag("h1", gates_verdict(records) + (red == 0 && !faults.empty() ? failed : ""),
                        good ? "class=\"holds\"" : "class=\"broken\"") +
                    "\n";
  out += tag("p",
             "A gate is a limit on one figure of one scene, computed anew in this run. A truth gate limits the error "
             "together with the reference's uncertainty, a drift gate the distance from the value last accepted.",
             "class=\"dim\"") +
         "\n<div class=\"tiles\">\n";
  out +=
      tile("Red", fmt::format("{}", red), fmt::format("of {} gate{}", records.size(), records.size() == 1 ? "" : "s"));
  const auto nearest = std::ranges::min_element(
      records, {}, [](const GateRecord& r) { return std::isfinite(r.held()) ? r.margin() / r.gate.limit : -INFINITY; });
  if (nearest != records.end()) {
    out += tile("Smallest margin",
                std::isfinite(nearest->held())
                    ? fmt::format("{:.0f}{}%", 100.0 * nearest->margin() / nearest->gate.limit, no_break)
                    : "no number",
                nearest->name());
  }
  out += tile("Faults beside the gates", fmt::format("{}", faults.size()), "of data, limits and proofs");
  if (!proofs.empty()) {
    out += tile("Proved", fmt::format("{} of {}", std::ranges::count_if(proofs, &GateProof::holds), proofs.size()),
                "turn red under their change");
  }
  return out + "</div>\n";
}

std::string red_section(const std::vector<GateRecord>& records, const std::vector<std::string>& faults) {
  std::string out;
  for (const GateRecord& record : records) {
    if (record.passes()) continue;
    out += "<dt>" + tag("a", record.name(), "href=\"#" + escape_xml(anchor(record)) + "\"") + "</dt>\n" +
           tag("dd", why_red(record) + ". The limit is there because: " + record.gate.reason + ".") + "\n";
  }
  for (const std::string& fault : faults) out += tag("dt", "Fault") + "\n" + tag("dd", fault) + "\n";
  return out.empty() ? "" : tag("h2", "What is red, and why") + "\n<dl>\n" + out + "</dl>\n";
}

std::string row(const GateRecord& record, const std::vector<GateProof>& proofs) {
  std::string out = fmt::format("<tr id=\"{}\"><td>{} ", escape_xml(anchor(record)), tag("b", record.gate.name));
  out += tag("span", record.passes() ? "holds" : "red", record.passes() ? "class=\"holds\"" : "class=\"broken\"");
  const std::string_view meaning = figure_meaning(record.gate.quantity);
  out += tag(
      "span",
      std::string(name_of(record.gate.kind)) + ": " + (meaning.empty() ? record.gate.quantity : std::string(meaning)),
      "class=\"under\"");
  out += "<details><summary>why, and what turns it red</summary>" + tag("p", record.gate.reason) + "<p>" +
         tag("code", fmt::format("{}", fmt::join(record.gate.red, " "))) + "</p>";
  const auto proof =
      std::ranges::find_if(proofs, [&](const GateProof& p) { return p.changed.name() == record.name(); });
  if (proof != proofs.end()) {
    out +=
        tag("p", proof->holds() ? "Proved: with it, " + held_text(proof->changed) + ", " + margin_text(proof->changed)
                                : "Not proved: " + proof->failure);
  }
  out += "<p>" + tag("code", record.gate.quantity) + "</p></details></td><td>" + bar(record);
  out += tag("span", margin_text(record)) + tag("span", held_text(record), "class=\"under\"");
  return out + "</td></tr>\n";
}

std::string table(const GateFolder& folder, const std::vector<GateRecord>& records,
                  const std::vector<GateProof>& proofs, const std::filesystem::path& out_folder) {
  std::string out = tag("h2", "Every gate") + "\n<table class=\"gates\">\n";
  std::string file;
  for (const GateRecord& record : records) {
    if (record.file != file) {
      file = record.file;
      const auto of = std::ranges::find(folder.files, file, &GateFile::name);
      out += "<tr class=\"group\"><th colspan=\"2\">" + escape_xml(of != folder.files.end() ? of->title : file);
      if (of != folder.files.end()) {
        out += "<span class=\"under\">" + link(folder.folder / (file + ".toml"), out_folder) + ", scene " +
               link(of->scene_file, out_folder) + "</span>";
      }
      out += "</th></tr>\n";
    }
    out += row(record, proofs);
  }
  return out + "</table>\n";
}

std::string origin(const scene::Manifest& manifest) {
  return tag("h2", "How this was made") + "\n<table>\n" + origin_rows(manifest) +
         "</table>\n<p>Beside this page: <a href=\"table.txt\">table.txt</a> (what the terminal showed), <a "
         "href=\"summary.json\">summary.json</a> (every number), <a href=\"manifest.json\">manifest.json</a>.</p>\n";
}

}  // namespace

std::string gate_page_html(const GateFolder& folder, const std::vector<GateRecord>& records,
                           const std::vector<std::string>& faults, const std::vector<GateProof>& proofs,
                           const scene::Manifest& manifest, const std::filesystem::path& out) {
  return page("Accuracy gates", style + head(records, faults, proofs) + red_section(records, faults) +
                                    table(folder, records, proofs, out) + origin(manifest));
}

}  // namespace touchstone::compare
