// The page a reader opens first: one self-contained HTML file, nothing fetched; a script only for the view in space.
#pragma once

#include "compare/errors/errors.h"
#include "compare/report/comparison_drawings.h"
#include "compare/report/model_table.h"
#include "compare/report/next_steps.h"
#include "compare/report/verdict.h"
#include "fast/run/run.h"
#include "reference/solver.h"
#include "scene/model/plan.h"
#include "scene/output/results.h"

#include <filesystem>

namespace touchstone::compare {

/// What each side models of the scene and leaves out.
struct Plans {
  scene::Plan fast, reference;
};

/// All a report is made of; refers to what the caller holds.
struct ReportContent {
  const scene::Scene& scene;
  const fast::Run& run;
  const reference::Result& result;
  const Errors& errors;
  const scene::Figures& figures;
  const Verdict& verdict;
  const ComparisonDrawings& drawings;
  const Plans& plans;
  const scene::Manifest& manifest;
  std::vector<JudgedModel> models{};  ///< which one to use; empty: no table
};

/// The page as well-formed XHTML, so that tools can read it too.
[[nodiscard]] std::string report_html(const ReportContent& content);

/// @throws std::filesystem::filesystem_error
void write_report(const std::filesystem::path& path, const ReportContent& content);

}  // namespace touchstone::compare
