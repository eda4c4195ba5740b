// The problems of `touchstone verify`: what the reference must reproduce, each with its source and its limit.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::verification {

/// One number compared with its target.
struct Check {
  std::string what;  ///< "force, nu = 0.3"
  std::string unit;  ///< of target and value; "" for a ratio
  double target = 0.0;
  double value = 0.0;
  double limit = 0.0;               ///< of the size of error()
  double scale = 0.0;               ///< what the error is relative to; 0: the target's size
  std::optional<double> mesh_band;  ///< uncertainty due to the mesh, relative like error()
  std::optional<double> order;      ///< in the cell size, as observed on the finest meshes

  [[nodiscard]] double error() const noexcept;
  /// Not a number misses.
  [[nodiscard]] bool passes() const noexcept;
};

/// Limits common to all problems.
inline constexpr double limit_of_closed_form = 0.002;   ///< the model solved is the model of the closed form
inline constexpr double limit_of_small_strain = 0.005;  ///< finite strain in its small-strain limit
inline constexpr double limit_of_table = 0.01;          ///< singular solutions and printed tables
inline constexpr double limit_of_pressure = 0.005;      ///< at a point, from nodal forces
inline constexpr double limit_of_stress = 0.005;        ///< at a point inside the body, of the largest pressure
/// Place of a contact's edge, where the pressure falls to zero with an infinite slope within one cell.
inline constexpr double limit_of_edge = 0.005;

/// A check of a quantity from successively finer meshes. The finest is checked; the uncertainty is force_band() of all;
/// the order comes from their differences and is absent where they change sign or grow, as a contact force's do when
/// the contact's edge moves by whole nodes.
/// @param values  coarsest first, each mesh with half the cell size of the one before
[[nodiscard]] Check from_levels(std::string what, std::string unit, double target, double limit,
                                const std::vector<double>& values);

/// Order p of an error that behaves like h^p, from meshes whose cell size halves; absent where it does not fall.
[[nodiscard]] std::optional<double> observed_order(double coarse_error, double fine_error);

/// How much is solved, and who receives reports.
struct Effort {
  bool quick = false;                                    ///< one mesh fewer, without the most expensive cases
  std::function<void(const std::string& text)> working;  ///< called before every solve; may be empty, may throw to stop
  void tell(const std::string& text) const {
    if (working) working(text);
  }
};

/// The results of a problem.
struct Findings {
  std::vector<Check> checks;
  std::vector<std::string> notes;  ///< what meshes, and which part of an error is whose, as measured in this run
};

struct Problem {
  std::string name;    ///< as given on the command line
  std::string title;   ///< one line
  std::string source;  ///< of the target
  std::function<Findings(const Effort& effort)> run;
};

/// All of them, in the order in which they are shown.
/// @throws reference::NotConverged from run
[[nodiscard]] const std::vector<Problem>& problems();

// By field.
[[nodiscard]] std::vector<Problem> solid_problems();
[[nodiscard]] std::vector<Problem> contact_problems();

}  // namespace touchstone::verification
