#include "compare/app/results_verb.h"

#include "compare/study/results_page.h"
#include "fast/command/command_line.h"
#include "scene/base/error.h"

#include <iostream>

namespace touchstone::compare {

int report_results(const ResultsOptions& options) {
  std::vector<ResultFolder> results;
  std::vector<scene::Fault> faults;
  for (const std::filesystem::path& folder : options.folders) {
    try {
      results.push_back(read_result_folder(folder));
    } catch (const scene::InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  const std::filesystem::path place = std::filesystem::absolute(options.out).parent_path();
  const std::string html = results_page_html(results, place);
  scene::require_writable(place, "--out");
  scene::write_file(options.out, html);
  std::cout << results.size() << (results.size() == 1 ? " result. Report: " : " results. Report: ")
            << options.out.string() << '\n';
  return fast::done;
}

fast::Command add_report_verb(fast::Command& program, ResultsOptions& options) {
  fast::Command verb = program.add("report", "write one page over many results of compare");
  verb.option("DIR", options.folders, "result folders").required();
  verb.option("--out", options.out, "the page's file").shows_default();
  verb.action([&options] { return report_results(options); });
  verb.example("report out/*-compare --out out/all.html");
  return verb;
}

}  // namespace touchstone::compare
