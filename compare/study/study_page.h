// A study on one page: every case by its name, and how the errors change along what varies.
#pragma once

#include "compare/study/study_run.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// The page as well-formed XHTML, for the study's folder. It links each case's report and picture by their
/// place in that folder, and needs nothing else, so that the folder can be moved as a whole. The errors are drawn over
/// every parameter whose values are numbers, by case where none are, and as a table of colours where two parameters
/// vary. An uncertainty that is not known is said to be so, in words and by a hollow mark.
/// @throws scene::InputError when a case's scene file cannot be read
[[nodiscard]] std::string study_page_html(const StudyManifest& manifest, const std::vector<StudyRow>& rows);

}  // namespace touchstone::compare
