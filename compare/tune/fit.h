// Bounded least squares that reports what the data do not determine: several starting points, active bounds, open
// parameters, profiles. Independent of contact. Minimised by Ceres (Levenberg-Marquardt, projected on the box).
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

struct FitParameter {
  std::string name;
  double low = 0.0, high = 0.0;
  double start = 0.0;
  bool log = false;  ///< searched in its logarithm

  /// Place within the bounds, 0 to 1, in the scale of the search.
  [[nodiscard]] double place(double value) const;
  [[nodiscard]] double value(double place) const;
};

/// Differences between model and data in units of the data's uncertainty. Nothing where the model has no answer: the
/// search stays away from there.
using Residuals = std::function<std::optional<Eigen::VectorXd>(const Eigen::VectorXd& values)>;

struct FitOptions {
  int starts = 4;  ///< the given one, the others spread over the bounds
  int iterations = 40;
  /// Independent observations behind the residuals; neighbouring points of one surface are not. 0: all residuals.
  int observations = 0;
};

/// Where one start ended.
struct FitStart {
  Eigen::VectorXd from, to;
  std::optional<double> chi2;  ///< sum of the squared residuals; absent where the model had no answer at `from`
};

enum class AtBound { no, low, high };

/// The result for one parameter.
struct Determination {
  double value = 0.0;
  AtBound at_bound = AtBound::no;
  bool open = false;  ///< determined no better than by its bounds
  /// Standard error, relative to the value where it is searched in its logarithm, in its unit otherwise. Absent at an
  /// active bound and for an open parameter, where a bare number would mislead; where another bound is active it holds
  /// only while that parameter stays there.
  std::optional<double> error;
};

struct Fit {
  Eigen::VectorXd value;
  Eigen::VectorXd residual;
  double chi2 = 0.0;
  double chi2_per_freedom =
      0.0;  ///< over observations - free parameters; far above 1: the model cannot follow the data
  std::vector<FitStart> starts;
  int starts_agreeing = 0;  ///< that ended within 1 % of the best chi2 and of its place
  std::vector<Determination> parameters;
  /// Of the parameters away from their bounds; NaN where one is at a bound or open.
  Eigen::MatrixXd correlation;
  int rank = 0, free = 0;  ///< of the Jacobian, and how many columns it has: parameters away from their bounds
  double condition = 0.0;  ///< of the Jacobian, parameters scaled by their bounds; infinite where rank < free
  /// Directions that the data leave open: in each the parameters that take part in it.
  std::vector<std::vector<std::size_t>> open_directions;
};

/// A parameter counts as open when its standard error exceeds this fraction of its bounds; that of a number of which
/// nothing is known between them is 0.29.
inline constexpr double open_share = 0.25;

/// @throws std::runtime_error when the model has no answer at any start
[[nodiscard]] Fit fit(const std::vector<FitParameter>& parameters, const Residuals& residuals,
                      const FitOptions& options);

/// The best chi2 with one parameter fixed, at values from bound to bound.
struct Profile {
  std::size_t parameter = 0;
  std::vector<double> values, chi2;   ///< NaN where the model has no answer
  std::vector<Eigen::VectorXd> best;  ///< of all parameters there
  /// Where chi2 exceeds the smallest by no more than chi2_per_freedom (at least 1), between the values tried.
  double low = 0.0, high = 0.0;
  bool open_low = false, open_high = false;  ///< that range reaches the bound
};

/// @param points  values tried, evenly spaced in the scale of the search, the fit's own added
[[nodiscard]] Profile profile(const std::vector<FitParameter>& parameters, const Residuals& residuals, const Fit& fit,
                              std::size_t parameter, int points);

struct ProfiledFit {
  Fit fit;
  std::vector<Profile> profiles;  ///< one for each of `profiled`
  int rounds = 0;                 ///< fits made
};

/// Fits and takes profiles. With a rough parameter a descent may end in a local minimum: if a profile finds a better
/// one, better by more than a thousandth of chi2, the given start moves there and all is fitted again, up to six times.
/// @param profiled  parameters to take a profile of; @param points  as of `profile`
[[nodiscard]] ProfiledFit fit_through_profiles(std::vector<FitParameter> parameters, const Residuals& residuals,
                                               const FitOptions& options, const std::vector<std::size_t>& profiled,
                                               int points);

}  // namespace touchstone::compare
