#include "compare/report/call.h"

#include "fast/command/command_line.h"

namespace touchstone::compare {

void add_compare_options(fast::Command command, CompareOptions& options) {
  command.option("--parameters", options.parameters, "constants written by tune; only the fast model uses them");
  command
      .option("--model", options.models,
              "another model for the table, by its key (see reports/trade.md), such as compliance-1; may be repeated")
      .one_value_each_time();
  command.flag("--plots", options.plots, "every plot of the report also as SVG and PDF, in the folder's plots/");
}

std::string command_text(const Call& call, const std::string& options) {
  std::string text = "touchstone compare " + fast::shell_word(call.scene_file.string());
  for (const std::string& setting : call.overrides) text += " --set " + fast::shell_word(setting);
  const CompareOptions& compare = call.compare;
  if (!compare.parameters.empty()) text += " --parameters " + fast::shell_word(compare.parameters.string());
  for (const std::string& key : compare.models) text += " --model " + fast::shell_word(key);
  if (compare.plots) text += " --plots";
  return text + options_text(call.reference) + options;
}

}  // namespace touchstone::compare
