// Which model to use: several models judged by the same answer of the reference, as a table.
#pragma once

#include "compare/model/judge.h"
#include "scene/output/figures.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// The table for a terminal, with a line that explains it.
[[nodiscard]] std::string model_table_text(const std::vector<JudgedModel>& models);

/// The table for a page.
[[nodiscard]] std::string model_table_html(const std::vector<JudgedModel>& models);

/// `model.<key>.force.nrmse`, .shape.rel_l2 with their uncertainty, .step_us.p50.
[[nodiscard]] scene::Figures model_figures(const std::vector<JudgedModel>& models);

}  // namespace touchstone::compare
