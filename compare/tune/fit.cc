#include "compare/tune/fit.h"

#include <Eigen/SVD>

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace touchstone::compare {
namespace {

/// Step of the difference quotients, as a fraction of the distance between the bounds.
constexpr double difference = 1e-3;

/// A parameter closer to a bound than this fraction counts as at the bound.
constexpr double bound_share = 1e-3;

/// Singular values below this fraction of the largest, or of the scatter, count as zero.
constexpr double rank_share = 1e-9, effect_share = 1e-6;

/// A parameter takes part in a direction if its component is at least this large.
constexpr double part_of_direction = 0.3;

/// The residuals as a function of the free parameters; the others are fixed.
class Model {
 public:
  Model(const std::vector<FitParameter>& parameters, const Residuals& residuals, Eigen::VectorXd held,
        std::vector<std::size_t> free)
      : parameters_(parameters), residuals_(residuals), held_(std::move(held)), free_(std::move(free)) {}

  [[nodiscard]] std::size_t count() const noexcept { return free_.size(); }
  [[nodiscard]] Eigen::VectorXd values(const double* places) const {
    Eigen::VectorXd all = held_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      all[static_cast<Eigen::Index>(free_[k])] = parameters_[free_[k]].value(places[k]);
    }
    return all;
  }
  [[nodiscard]] std::optional<Eigen::VectorXd> at(const double* places) const {
    std::optional<Eigen::VectorXd> residual = residuals_(values(places));
    if (residual && !residual->allFinite()) residual.reset();
    return residual;
  }
  /// Central differences; one-sided at a bound, and where the model has no result on one side.
  [[nodiscard]] std::optional<Eigen::MatrixXd> jacobian(const double* places, const Eigen::VectorXd& here) const {
    Eigen::MatrixXd out(here.size(), static_cast<Eigen::Index>(count()));
    std::vector<double> moved(places, places + count());
    for (std::size_t k = 0; k < count(); ++k) {
      const auto side = [&](double step) -> std::optional<Eigen::VectorXd> {
        moved[k] = places[k] + step;
        if (moved[k] < 0.0 || moved[k] > 1.0) return std::nullopt;
        return at(moved.data());
      };
      const std::optional<Eigen::VectorXd> below = side(-difference), above = side(difference);
      moved[k] = places[k];
      if (!below && !above) return std::nullopt;
      const double width = (below ? difference : 0.0) + (above ? difference : 0.0);
      out.col(static_cast<Eigen::Index>(k)) = ((above ? *above : here) - (below ? *below : here)) / width;
    }
    return out;
  }

 private:
  const std::vector<FitParameter>& parameters_;
  const Residuals& residuals_;
  Eigen::VectorXd held_;
  std::vector<std::size_t> free_;
};

class Cost : public ceres::CostFunction {
 public:
  Cost(const Model& model, int residuals) : model_(model) {
    set_num_residuals(residuals);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(model.count()));
  }
  bool Evaluate(double const* const* places, double* residuals, double** jacobians) const override {
    const std::optional<Eigen::VectorXd> here = model_.at(places[0]);
    if (!here) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, here->size()) = *here;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const std::optional<Eigen::MatrixXd> jacobian = model_.jacobian(places[0], *here);
    if (!jacobian) return false;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], jacobian->rows(), jacobian->cols()) = *jacobian;
    return true;
  }

 private:
  const Model& model_;
};

/// Minimises from the start `places`, which it updates. @returns chi2 at the end; nothing if the model has no result at
/// the start
std::optional<double> descend(const Model& model, std::vector<double>& places, int iterations) {
  const std::optional<Eigen::VectorXd> first = model.at(places.data());
  if (!first) return std::nullopt;
  if (model.count() == 0) return first->squaredNorm();
  const Cost cost(model, static_cast<int>(first->size()));
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  problem.AddResidualBlock(const_cast<Cost*>(&cost), nullptr, places.data());
  for (int k = 0; k < static_cast<int>(model.count()); ++k) {
    problem.SetParameterLowerBound(places.data(), k, 0.0);
    problem.SetParameterUpperBound(places.data(), k, 1.0);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = iterations;
  solver.function_tolerance = 1e-9;
  solver.parameter_tolerance = 1e-8;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return 2.0 * summary.final_cost;
}

/// Halton's sequence: points that fill the unit cube evenly.
double halton(int index, int base) {
  double place = 0.0, share = 1.0;
  for (; index > 0; index /= base) place += (share /= base) * (index % base);
  return place;
}

std::vector<std::size_t> all_of(std::size_t count) {
  std::vector<std::size_t> list(count);
  for (std::size_t k = 0; k < count; ++k) list[k] = k;
  return list;
}

/// Standard errors, correlations and undetermined directions, from the Jacobian at the best fit.
void determine(const std::vector<FitParameter>& parameters, const Residuals& residuals,
               const std::vector<double>& places, int observations, Fit& fit) {
  const std::size_t count = parameters.size();
  for (const double value : fit.value) fit.parameters.emplace_back().value = value;
  fit.chi2_per_freedom = fit.chi2 / std::max(1, observations - static_cast<int>(count));
  const double none = std::numeric_limits<double>::quiet_NaN();
  fit.correlation = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count), none);
  const Model model(parameters, residuals, fit.value, all_of(count));
  const std::optional<Eigen::MatrixXd> all = model.jacobian(places.data(), fit.residual);
  if (!all) throw std::runtime_error("the model has no result next to the fitted values");
  // The misfit of the model counts as scatter, so that the standard errors reflect the misfit and not the data's
  // uncertainty.
  const double scatter = std::sqrt(std::max(1.0, fit.chi2_per_freedom));
  std::vector<std::size_t> inner;
  for (std::size_t k = 0; k < count; ++k) {
    // A parameter without effect stays at its start value.
    const bool counts = all->col(static_cast<Eigen::Index>(k)).norm() * open_share >= scatter;
    if (counts && places[k] < bound_share) {
      fit.parameters[k].at_bound = AtBound::low;
    } else if (counts && places[k] > 1.0 - bound_share) {
      fit.parameters[k].at_bound = AtBound::high;
    } else {
      inner.push_back(k);
    }
  }
  fit.free = static_cast<int>(inner.size());
  if (inner.empty()) return;
  Eigen::MatrixXd jacobian(all->rows(), fit.free);
  for (std::size_t k = 0; k < inner.size(); ++k) {
    jacobian.col(static_cast<Eigen::Index>(k)) = all->col(static_cast<Eigen::Index>(inner[k]));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
  Eigen::VectorXd singular = Eigen::VectorXd::Zero(jacobian.cols());
  singular.head(svd.singularValues().size()) = svd.singularValues();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(singular.size(), singular.size());
  for (Eigen::Index k = 0; k < singular.size(); ++k) {
    const bool counted = singular[k] > std::max(rank_share * singular[0], effect_share * scatter);
    fit.rank += counted ? 1 : 0;
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    const double width = counted ? scatter / singular[k] : std::numeric_limits<double>::infinity();
    if (width > open_share) {
      std::vector<std::size_t>& parts = fit.open_directions.emplace_back();
      for (Eigen::Index i = 0; i < direction.size(); ++i) {
        if (std::abs(direction[i]) >= part_of_direction) parts.push_back(inner[static_cast<std::size_t>(i)]);
      }
    }
    // Cap the standard error of a direction without effect, so that the covariance stays finite.
    const double told = std::min(width, 1e6);
    covariance += told * told * direction * direction.transpose();
  }
  fit.condition =
      fit.rank < fit.free ? std::numeric_limits<double>::infinity() : singular[0] / singular[singular.size() - 1];
  for (Eigen::Index i = 0; i < singular.size(); ++i) {
    Determination& one = fit.parameters[inner[static_cast<std::size_t>(i)]];
    const FitParameter& parameter = parameters[inner[static_cast<std::size_t>(i)]];
    const double width = std::sqrt(covariance(i, i));
    one.open = width > open_share;
    if (!one.open)
      one.error = width * (parameter.log ? std::log(parameter.high / parameter.low) : parameter.high - parameter.low);
  }
  for (std::size_t i = 0; i < inner.size(); ++i) {
    for (std::size_t j = 0; j < inner.size(); ++j) {
      if (fit.parameters[inner[i]].open || fit.parameters[inner[j]].open) continue;
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      fit.correlation(static_cast<Eigen::Index>(inner[i]), static_cast<Eigen::Index>(inner[j])) =
          covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
    }
  }
}

}  // namespace

double FitParameter::place(double value) const {
  const double share = log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::clamp(share, 0.0, 1.0);
}

double FitParameter::value(double place) const {
  if (place <= 0.0) return low;
  if (place >= 1.0) return high;
  return log ? low * std::pow(high / low, place) : low + place * (high - low);
}

Fit fit(const std::vector<FitParameter>& parameters, const Residuals& residuals, const FitOptions& options) {
  constexpr int primes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  const std::size_t count = parameters.size();
  const Model model(parameters, residuals, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count)), all_of(count));
  Fit out;
  std::vector<double> best;
  for (int start = 0; start < std::max(1, options.starts); ++start) {
    std::vector<double> places(count);
    for (std::size_t k = 0; k < count; ++k) {
      places[k] = start == 0 ? parameters[k].place(parameters[k].start) : halton(start, primes[k % std::size(primes)]);
    }
    FitStart& one = out.starts.emplace_back();
    one.from = model.values(places.data());
    one.chi2 = descend(model, places, options.iterations);
    one.to = model.values(places.data());
    if (one.chi2 && (best.empty() || *one.chi2 < out.chi2)) {
      best = places;
      out.chi2 = *one.chi2;
    }
    if (count == 0) break;
  }
  if (best.empty() && count > 0) throw std::runtime_error("the model has no result at any start of the fit");
  out.value = model.values(best.data());
  out.residual = model.at(best.data()).value();
  for (const FitStart& one : out.starts) {
    double apart = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      apart = std::max(apart, std::abs(parameters[k].place(one.to[static_cast<Eigen::Index>(k)]) - best[k]));
    }
    out.starts_agreeing += one.chi2 && *one.chi2 <= 1.01 * out.chi2 + 1e-9 && apart <= 0.01 ? 1 : 0;
  }
  const int observations = options.observations > 0 ? options.observations : static_cast<int>(out.residual.size());
  determine(parameters, residuals, best, observations, out);
  return out;
}

Profile profile(const std::vector<FitParameter>& parameters, const Residuals& residuals, const Fit& fit,
                std::size_t parameter, int points) {
  constexpr int iterations = 15;
  Profile out;
  out.parameter = parameter;
  std::vector<std::size_t> others = all_of(parameters.size());
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(parameter));
  std::vector<double> along = {parameters[parameter].place(fit.value[static_cast<Eigen::Index>(parameter)])};
  for (int k = 0; k < points; ++k) along.push_back(static_cast<double>(k) / (points - 1));
  std::sort(along.begin(), along.end());
  double least = fit.chi2;
  for (const double place : along) {
    Eigen::VectorXd held = fit.value;
    held[static_cast<Eigen::Index>(parameter)] = parameters[parameter].value(place);
    const Model model(parameters, residuals, held, others);
    std::vector<double> places;
    for (const std::size_t k : others) places.push_back(parameters[k].place(fit.value[static_cast<Eigen::Index>(k)]));
    const std::optional<double> chi2 = descend(model, places, iterations);
    out.values.push_back(held[static_cast<Eigen::Index>(parameter)]);
    out.chi2.push_back(chi2.value_or(std::numeric_limits<double>::quiet_NaN()));
    out.best.push_back(model.values(places.data()));
    if (chi2) least = std::min(least, *chi2);
  }
  const double limit = least + std::max(1.0, fit.chi2_per_freedom);
  out.low = out.high = fit.value[static_cast<Eigen::Index>(parameter)];
  for (std::size_t k = 0; k < out.values.size(); ++k) {
    if (!(out.chi2[k] <= limit)) continue;
    out.low = std::min(out.low, out.values[k]);
    out.high = std::max(out.high, out.values[k]);
  }
  out.open_low = out.low <= parameters[parameter].value(bound_share);
  out.open_high = out.high >= parameters[parameter].value(1.0 - bound_share);
  return out;
}

ProfiledFit fit_through_profiles(std::vector<FitParameter> parameters, const Residuals& residuals,
                                 const FitOptions& options, const std::vector<std::size_t>& profiled, int points) {
  constexpr double better = 0.999;
  constexpr int rounds_max = 6;
  ProfiledFit out;
  while (out.rounds < rounds_max) {
    out.fit = fit(parameters, residuals, options);
    ++out.rounds;
    out.profiles.clear();
    for (const std::size_t k : profiled) out.profiles.push_back(profile(parameters, residuals, out.fit, k, points));
    double least = better * out.fit.chi2;
    const Eigen::VectorXd* from = nullptr;
    for (const Profile& one : out.profiles) {
      for (std::size_t at = 0; at < one.chi2.size(); ++at) {
        if (!(one.chi2[at] < least)) continue;
        least = one.chi2[at];
        from = &one.best[at];
      }
    }
    if (from == nullptr) break;
    for (std::size_t k = 0; k < parameters.size(); ++k) parameters[k].start = (*from)[static_cast<Eigen::Index>(k)];
  }
  return out;
}

}  // namespace touchstone::compare
