// Domination of rows and the sentences about them; trade_rows.cc computes the rows.
#include "compare/trade/trade.h"

#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::compare {
namespace {

/// The two quantities by which rows are compared.
struct Point {
  double step_us = 0.0, error = 0.0;
};

std::optional<Point> point_of(const TradeRow& row, TradeError error) {
  const std::optional<double> judged = judged_error(row.*error);
  if (!judged || !std::isfinite(row.step_p50_us)) return std::nullopt;
  return Point{row.step_p50_us, *judged};
}

bool dominates(const Point& a, const Point& b) {
  return a.step_us <= b.step_us && a.error <= b.error && (a.step_us < b.step_us || a.error < b.error);
}

std::string error_in_words(const Measure& error) {
  return percent_text(*error.value) + (error.distinguishable() ? "" : " (not distinguishable from zero)");
}

/// The row with the smallest error among those that pass; null if none passes.
template <class Pass>
const TradeRow* most_accurate(const Trade& trade, TradeError error, Pass pass) {
  const TradeRow* best = nullptr;
  Point best_point;
  for (const TradeRow& row : trade.rows) {
    const std::optional<Point> point = point_of(row, error);
    if (!point || !pass(row)) continue;
    if (best != nullptr &&
        (point->error > best_point.error || (point->error == best_point.error && point->step_us >= best_point.step_us)))
      continue;
    best = &row;
    best_point = *point;
  }
  return best;
}

std::string with_numbers(const TradeRow& row, TradeError error) {
  return fmt::format("{} ({}, {} a step)", row.name, error_in_words(row.*error), quantity_text(row.step_p50_us, "us"));
}

/// A remark about a row whose slowest steps take longer than a tick; else empty.
std::string late_text(const Trade& trade, const TradeRow& row) {
  if (row.step_p999_us <= trade.tick_us) return "";
  return fmt::format(" (except its slowest steps: p99.9 {} in this run)", quantity_text(row.step_p999_us, "us"));
}

/// Says whether the paper's model is on the Pareto front of one error.
std::string paper_sentence(const Trade& trade, TradeError error, const std::string& what) {
  const auto of_paper = [](const TradeRow& row) { return row.family == ModelFamily::paper; };
  const TradeRow* paper = most_accurate(trade, error, of_paper);
  if (paper == nullptr) {
    return std::any_of(trade.rows.begin(), trade.rows.end(), of_paper)
               ? "The paper's model has no " + what + " that can be judged."
               : "No row of the " + what + " is the paper's model; the absent rows say why.";
  }
  const std::string best = fmt::format("In {} the best of the paper's model is {}", what, with_numbers(*paper, error));
  const std::optional<std::size_t> by =
      dominating(trade.rows, error)[static_cast<std::size_t>(paper - trade.rows.data())];
  if (by && !of_paper(trade.rows[*by])) {
    std::string text = fmt::format("{}. It is dominated: {} is no slower and no less accurate.", best,
                                   with_numbers(trade.rows[*by], error));
    const std::vector<std::size_t> front = pareto_front(trade.rows, error);
    const auto left = std::find_if(front.begin(), front.end(), [&](std::size_t k) { return of_paper(trade.rows[k]); });
    if (left != front.end()) {
      text += fmt::format(" Of the paper's model only what is faster and worse stays on the front, such as {}.",
                          with_numbers(trade.rows[*left], error));
    }
    return text;
  }
  const TradeRow* rival = most_accurate(trade, error, [&](const TradeRow& row) {
    return !of_paper(row) && row.family != ModelFamily::reference && row.step_p50_us <= trade.tick_us;
  });
  if (rival == nullptr || *judged_error(rival->*error) >= *judged_error(paper->*error)) {
    const bool worse_than_none = error == &TradeRow::shape_rel_l2 && *judged_error(paper->*error) >= 1.0;
    return best + ". No other model that keeps up with the device loop is as accurate" +
           (worse_than_none ? ", except the rest shape, whose error is 100 % and which takes no time." : ".");
  }
  const double ratio = *judged_error(paper->*error) / *judged_error(rival->*error);
  return fmt::format(
      "{}; it is on the front for its speed alone. It is less accurate: {} keeps up with the device loop of "
      "{} as well{}, at {} times the time of a step and one part in {} of the error.",
      best, with_numbers(*rival, error), quantity_text(trade.tick_us, "us"), late_text(trade, *rival),
      number_text(rival->step_p50_us / paper->step_p50_us), number_text(ratio));
}

}  // namespace

std::optional<double> judged_error(const Measure& error) {
  if (!error.value || !std::isfinite(*error.value)) return std::nullopt;
  return std::max(std::abs(*error.value), error.uncertainty.value_or(0.0));
}

std::vector<std::optional<std::size_t>> dominating(const std::vector<TradeRow>& rows, TradeError error) {
  std::vector<std::optional<std::size_t>> by(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::optional<Point> mine = point_of(rows[i], error);
    std::optional<Point> best;
    for (std::size_t j = 0; j < rows.size() && mine; ++j) {
      const std::optional<Point> other = point_of(rows[j], error);
      if (!other || !dominates(*other, *mine)) continue;
      if (best && std::pair(best->error, best->step_us) <= std::pair(other->error, other->step_us)) continue;
      best = other;
      by[i] = j;
    }
  }
  return by;
}

std::vector<std::size_t> pareto_front(const std::vector<TradeRow>& rows, TradeError error) {
  const std::vector<std::optional<std::size_t>> by = dominating(rows, error);
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (point_of(rows[i], error) && !by[i]) front.push_back(i);
  }
  std::stable_sort(front.begin(), front.end(),
                   [&](std::size_t a, std::size_t b) { return rows[a].step_p50_us < rows[b].step_p50_us; });
  return front;
}

std::vector<std::string> trade_verdict(const Trade& trade) {
  std::vector<std::string> out;
  const auto any = [](const TradeRow&) { return true; };
  for (const auto& [error, what] : {std::pair(&TradeRow::force_nrmse, std::string("force")),
                                    std::pair(&TradeRow::shape_rel_l2, std::string("shape"))}) {
    out.push_back(paper_sentence(trade, error, what));
    const TradeRow* in_time =
        most_accurate(trade, error, [&](const TradeRow& row) { return row.step_p50_us <= trade.tick_us; });
    if (in_time != nullptr) {
      out.push_back(fmt::format("The most accurate {} within a tick of {} (median){}: {}.", what,
                                quantity_text(trade.tick_us, "us"), late_text(trade, *in_time),
                                with_numbers(*in_time, error)));
    } else if (const TradeRow* best = most_accurate(trade, error, any); best != nullptr) {
      out.push_back(fmt::format("Nothing keeps up with a tick of {} in {}; the most accurate of all is {}.",
                                quantity_text(trade.tick_us, "us"), what, with_numbers(*best, error)));
    }
  }
  return out;
}

}  // namespace touchstone::compare
