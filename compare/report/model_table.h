// Which model to use: the scene's own model beside the paper's as printed and the area-aware law that needs no tuning,
// all judged against the same reference answer.
#pragma once

#include "compare/errors/errors.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// One model's row. Errors are those of Errors, with the reference's uncertainty.
struct JudgedModel {
  std::string key;     ///< in summary.json: `model.<key>.force.nrmse` and so on
  std::string name;    ///< "paper as printed"
  std::string method;  ///< law and skeleton, "Duffing, published"
  Measure force_nrmse, shape_rel_l2;
  double step_p50_us = 0.0;  ///< whole step, over all ticks of the track
  std::uint32_t status = 0;  ///< OR of all StepStatus bits
};

/// Runs and judges the models that stand beside the one already run.
/// @param given   the scene as in its file
/// @param judged  the scene that was run: `given`, or with tuned constants
/// @param run, errors  of `judged`
/// @param tuned   name of the parameter file; empty: none
/// @returns the paper's model first, then the area-aware law, then the scene's own constants, then the tuned ones; a
///          model that is the same as another appears once
[[nodiscard]] std::vector<JudgedModel> judge_models(const scene::Scene& given, const scene::Scene& judged,
                                                    const fast::Run& run, const Errors& errors,
                                                    const reference::Result& result, const std::string& tuned);

/// The table for a terminal, with a line that explains it.
[[nodiscard]] std::string model_table_text(const std::vector<JudgedModel>& models);

/// The table for a page.
[[nodiscard]] std::string model_table_html(const std::vector<JudgedModel>& models);

/// `model.<key>.force.nrmse`, .shape.rel_l2 with their uncertainty, .step_us.p50.
[[nodiscard]] scene::Figures model_figures(const std::vector<JudgedModel>& models);

}  // namespace touchstone::compare
