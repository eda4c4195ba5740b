// What every page of results is made of: one self-contained XHTML file that may fetch nothing but pictures
// in its folder. Plots show the values at the pointer.
#pragma once

#include "scene/model/plan.h"
#include "scene/output/results.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// An element around a text, which is escaped. @param attributes as written within the tag
[[nodiscard]] std::string tag(const std::string& name, const std::string& text, const std::string& attributes = "");

[[nodiscard]] std::string cell(const std::string& text);
[[nodiscard]] std::string number_cell(const std::string& text);

/// A drawing with its caption, which may be empty.
/// @param wide  takes a whole row among others
[[nodiscard]] std::string figure(const std::string& svg, const std::string& caption, bool wide = false);

/// One large number with what it is and a note.
[[nodiscard]] std::string tile(const std::string& what, const std::string& number, const std::string& note);

/// What the page calls the scene.
[[nodiscard]] std::string scene_title(const scene::Scene& scene);

[[nodiscard]] std::string plan_table(const scene::Plan& plan);

/// A part of a page under its heading.
struct Section {
  std::string title, body;
  bool folded = false;  ///< the reader opens it
};

/// Links to all parts, one line. A part without a body is left out, here and in in_order().
[[nodiscard]] std::string contents(const std::vector<Section>& sections);
/// The parts themselves.
[[nodiscard]] std::string in_order(const std::vector<Section>& sections);

/// Rows of a table of two columns: the command, the manifest's entries and the wall times.
[[nodiscard]] std::string origin_rows(const scene::Manifest& manifest);

/// @param beside  what else the folder holds, a sentence
[[nodiscard]] Section origin(const scene::Manifest& manifest, const std::string& beside);
/// Every value in force, folded.
[[nodiscard]] Section resolved_scene(const scene::Manifest& manifest);

/// Both of them.
[[nodiscard]] std::string manifest_section(const scene::Manifest& manifest, const std::string& beside);

/// The whole file around a body.
[[nodiscard]] std::string page(const std::string& title, const std::string& body);

}  // namespace touchstone::compare
