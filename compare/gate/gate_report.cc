#include "compare/gate/gate_report.h"

#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::compare {
namespace {

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-"; }

template <std::size_t columns>
std::string table(const std::array<const char*, columns>& head,
                  const std::vector<std::array<std::string, columns>>& rows) {
  std::array<std::size_t, columns> width{};
  for (std::size_t k = 0; k < columns; ++k) {
    width[k] = std::string_view(head[k]).size();
    for (const auto& row : rows) width[k] = std::max(width[k], row[k].size());
  }
  std::string text;
  const auto line = [&](const auto& row) {
    std::string out = fmt::format("{:<{}}", row[0], width[0]);
    for (std::size_t k = 1; k < columns; ++k) out += fmt::format("  {:>{}}", row[k], width[k]);
    text += out + "\n";
  };
  line(head);
  for (const auto& row : rows) line(row);
  return text;
}

/// Why the number exceeds the limit; a gate that is red for another reason has a text of its own.
std::string beyond_text(const GateRecord& record) {
  const std::string limit =
      fmt::format("{:.4g}{}{}", record.gate.limit, record.gate.unit.empty() ? "" : " ", record.gate.unit);
  if (record.gate.kind == GateKind::truth) {
    return fmt::format("|{:.4g}| + {:.4g} is beyond {}", *record.value, *record.uncertainty, limit);
  }
  return fmt::format("{:.9g} is beyond {} of the accepted {:.9g}", *record.value, limit, *record.accepted);
}

std::size_t red_count(const std::vector<GateRecord>& records) {
  return static_cast<std::size_t>(std::ranges::count_if(records, [](const GateRecord& r) { return !r.passes(); }));
}

}  // namespace

std::string gates_verdict(const std::vector<GateRecord>& records) {
  const std::size_t red = red_count(records), all = records.size();
  if (red == 0) return all == 1 ? "The gate holds" : fmt::format("All {} gates hold", all);
  if (all == 1) return "The gate is red";
  return fmt::format("{} of {} gates {} red", red, all, red == 1 ? "is" : "are");
}

std::string why_red(const GateRecord& record) { return record.failure.empty() ? beyond_text(record) : record.failure; }

std::string gates_text(const std::vector<GateRecord>& records, const std::vector<std::string>& faults) {
  std::vector<std::array<std::string, 8>> rows;
  for (const GateRecord& record : records) {
    rows.push_back(
        {record.name(), name_of(record.gate.kind), record.value ? cell(*record.value) : "-", cell(record.held()),
         cell(record.gate.limit),
         std::isfinite(record.margin()) ? fmt::format("{:.0f} %", 100.0 * record.margin() / record.gate.limit) : "-",
         record.gate.unit, record.passes() ? "ok" : "RED"});
  }
  std::string text = table<8>({"gate", "kind", "value", "held", "limit", "margin", "unit", ""}, rows) + "\n";
  for (const GateRecord& record : records) {
    if (record.passes()) continue;
    text += wrapped(fmt::format("RED {}: {}. The limit is there because: {}", record.name(), why_red(record),
                                record.gate.reason)) +
            "\n";
  }
  for (const std::string& fault : faults) text += wrapped("RED " + fault) + "\n";
  text += gates_verdict(records);
  if (!faults.empty()) {
    text += fmt::format("; {} fault{} beside the gates", faults.size(), faults.size() == 1 ? "" : "s");
  }
  return text + ".\n";
}

std::string proofs_text(const std::vector<GateProof>& proofs) {
  std::vector<std::array<std::string, 6>> rows;
  for (const GateProof& proof : proofs) {
    const GateRecord& record = proof.changed;
    rows.push_back({record.name(), fmt::format("{}", fmt::join(record.gate.red, " ")), cell(record.held()),
                    cell(record.gate.limit), record.gate.unit, proof.holds() ? "red" : "NOT PROVED"});
  }
  std::string text = table<6>({"gate", "with", "held", "limit", "unit", ""}, rows) + "\n";
  for (const GateProof& proof : proofs) {
    if (!proof.holds()) text += wrapped("NOT PROVED " + proof.changed.name() + ": " + proof.failure) + "\n";
  }
  const auto proved = std::ranges::count_if(proofs, &GateProof::holds);
  return text + fmt::format("{} of {} gates turn red under their change.\n", proved, proofs.size());
}

scene::Figures gate_report_figures(const std::vector<GateRecord>& records, const std::vector<std::string>& faults) {
  scene::Figures figures{{"gate.count", static_cast<double>(records.size()), "", ""},
                         {"gate.red", static_cast<double>(red_count(records)), "", ""},
                         {"gate.faults", static_cast<double>(faults.size()), "", ""}};
  for (const GateRecord& record : records) {
    const std::string key = "gate." + record.name() + ".";
    const auto add = [&](const char* name, const std::optional<double>& number) {
      if (number) figures.push_back({key + name, *number, "", record.gate.unit});
    };
    add("value", record.value);
    add("uncertainty", record.uncertainty);
    add("accepted", record.accepted);
    add("held", record.held());
    add("limit", record.gate.limit);
    add("margin", record.margin());
    figures.push_back({key + "verdict", 0.0, record.passes() ? "ok" : "red: " + why_red(record), ""});
  }
  return figures;
}

std::string gates_junit(const std::vector<GateRecord>& records, const std::vector<std::string>& faults) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"accuracy gates\" tests=\"{}\" "
      "failures=\"{}\" errors=\"0\" skipped=\"0\">\n",
      records.size() + 1, red_count(records) + (faults.empty() ? 0 : 1));
  for (const GateRecord& record : records) {
    text += fmt::format("<testcase classname=\"gate.{}\" name=\"{}\">\n<properties>\n", escape_xml(record.file),
                        escape_xml(record.gate.name));
    const auto property = [&](const char* name, const std::string& value) {
      text += fmt::format("<property name=\"{}\" value=\"{}\"/>\n", name, escape_xml(value));
    };
    const auto number = [&](const char* name, const std::optional<double>& value) {
      if (value) property(name, fmt::format("{}", *value));
    };
    property("quantity", record.gate.quantity);
    property("kind", name_of(record.gate.kind));
    property("unit", record.gate.unit);
    number("value", record.value);
    number("uncertainty", record.uncertainty);
    number("accepted", record.accepted);
    number("limit", record.gate.limit);
    number("margin", record.margin());
    property("reason", record.gate.reason);
    text += "</properties>\n";
    if (!record.passes()) text += fmt::format("<failure message=\"{}\"/>\n", escape_xml(why_red(record)));
    text += "</testcase>\n";
  }
  text += "<testcase classname=\"gate\" name=\"faults\">\n";
  if (!faults.empty()) {
    text += fmt::format("<failure message=\"{}\">{}</failure>\n", escape_xml(faults.front()),
                        escape_xml(fmt::format("{}", fmt::join(faults, "\n"))));
  }
  return text + "</testcase>\n</testsuite>\n</testsuites>\n";
}

}  // namespace touchstone::compare
