#include "compare/app/prepare_verb.h"

#include "compare/model/response_model.h"
#include "fast/command/exit_code.h"
#include "fast/command/progress_line.h"

#include <fmt/format.h>

#include <iostream>

namespace touchstone::compare {
namespace {

int run(const fast::VerbOptions& options, const ReferenceOptions& reference) {
  const scene::Scene scene = options.load();
  fast::ProgressLine line(options.quiet);
  const reference::Prepared prepared =
      prepare(scene, reference.store, [&](const std::string& text, bool marked) { line.show(text, marked); });
  line.finish();
  std::cout << fmt::format(
      "{} columns, {} rest points, {} unknowns, {}\nInterpolation between the columns' places: off by {:.2g} % of a "
      "column\nResponse: {} ({:.3g} MB)\n",
      prepared.response.own_m_per_n.cols(), prepared.response.rest_points(), prepared.response.unknowns,
      prepared.computed ? fmt::format("computed in {:.3g} s", prepared.seconds) : "from the store",
      100.0 * prepared.response.interpolation_rel, prepared.file.string(),
      1e-6 * static_cast<double>(std::filesystem::file_size(prepared.file)));
  return fast::done;
}

}  // namespace

void add_prepare_verb(fast::Command& program, fast::VerbOptions& options, ReferenceOptions& reference) {
  add_store_option(
      fast::add_verb(program, "prepare", "compute the body's linear response, which the response model reads",
                     "meshes/scenes/ball-on-cube-press.toml", options, [&] { return run(options, reference); }),
      reference);
}

}  // namespace touchstone::compare
