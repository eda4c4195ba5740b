// The trade: step time against errors of every model. One row per model and level, on one machine in
// one run.
#pragma once

#include "compare/errors/errors.h"
#include "compare/input/tuning_study.h"
#include "compare/model/registry.h"
#include "compare/tune/tuning.h"
#include "reference/solver.h"
#include "scene/output/results.h"

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// One model at one size. NaN: not known.
struct TradeRow {
  std::string name;     ///< "corrected, 4k triangles"
  std::string key;      ///< of summary.json: "corrected-4k"
  std::string label{};  ///< short, for the plot
  ModelFamily family = ModelFamily::paper;
  std::string absent{};  ///< why there is nothing to measure; empty where there is
  std::string note{};    ///< a remark for comparing it
  int size = 0;          ///< surface triangles, or unknowns
  double step_p50_us = std::numeric_limits<double>::quiet_NaN();
  double step_p999_us = std::numeric_limits<double>::quiet_NaN();
  int steps = 0;  ///< measured
  double setup_s = std::numeric_limits<double>::quiet_NaN();
  double memory_bytes = std::numeric_limits<double>::quiet_NaN();
  Measure force_nrmse{}, shape_rel_l2{};         ///< of the contact where each is worst
  std::string force_contact{}, shape_contact{};  ///< that contact
};

/// A figure that rows are compared by.
using TradeError = Measure TradeRow::*;

/// The error for comparisons: at least the reference's uncertainty.
/// Nothing where it is not known at all.
[[nodiscard]] std::optional<double> judged_error(const Measure& error);

/// Per row the one that dominates it: neither slower (p50) nor worse in the error, and better in one of them. Of
/// several the one with the smallest error, then the fastest. Nothing for rows on the front and for those without both
/// numbers.
[[nodiscard]] std::vector<std::optional<std::size_t>> dominating(const std::vector<TradeRow>& rows, TradeError error);

/// The rows that nothing dominates, from the fastest to the slowest.
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<TradeRow>& rows, TradeError error);

struct Trade {
  std::string title;
  std::vector<TuningContact> contacts;  ///< what the errors are judged on
  bool held_out = false;                ///< they are a study's held-out ones
  double tick_us = 1000.0;              ///< of the scene's device loop
  std::vector<TradeRow> rows;
};

struct TradeOptions {
  std::vector<std::filesystem::path> parameters{};  ///< files of tuned constants, each one more row
  std::filesystem::path held_out{};                 ///< a tuning study; empty: judged on the scene
  bool quick = false;                               ///< few steps, small sizes
};

/// Sets up, times and judges every row.
/// @param solve  the reference, by number of levels; nothing: as many as the scene and the command line ask for
/// @param say    one line about what begins; may be empty
/// @param models the models to compare
/// @throws scene::InputError, and what `solve` throws
[[nodiscard]] Trade trade(
    const scene::Scene& scene, const TradeOptions& options,
    const std::function<reference::Result(const scene::Scene&, const scene::Surface&, std::optional<int>)>& solve,
    const std::function<void(const std::string&)>& say = {},
    const std::vector<ModelList>& models = registered_models());

/// Which models dominate, and whether the paper's model is among them; one sentence each.
[[nodiscard]] std::vector<std::string> trade_verdict(const Trade& trade);

/// The plot: time of a step over both errors, the fronts drawn, the points named.
[[nodiscard]] std::string trade_svg(const Trade& trade);

/// By stable dotted keys: `trade.<row>.<figure>`, trade.front_force and trade.front_shape.
[[nodiscard]] scene::Figures trade_figures(const Trade& trade);

/// trade.csv, trade.svg, summary.json, report.html, manifest.json. @throws std::filesystem::filesystem_error
void write_trade(const std::filesystem::path& folder, const Trade& trade, const scene::Manifest& manifest);

/// The table for a terminal.
[[nodiscard]] std::string trade_text(const Trade& trade);

}  // namespace touchstone::compare
