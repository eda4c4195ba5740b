// Many results on one page: a row and a picture of each, and their forces over one another.
#pragma once

#include "compare/report/result_folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// The page as well-formed XHTML. It links each result's report and shape.svg by their place relative to the page, and
/// needs nothing else from outside. An error within the reference's uncertainty is called not distinguishable.
/// @param results  folders of `touchstone compare`, at least one
/// @param place    folder of the page
/// @throws scene::InputError when a result is no comparison or its curve lacks a column the page draws
[[nodiscard]] std::string results_page_html(const std::vector<ResultFolder>& results,
                                            const std::filesystem::path& place);

}  // namespace touchstone::compare
