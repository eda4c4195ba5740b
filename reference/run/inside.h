// What is inside the body, read from the stored solutions of a result: nothing is solved.
#pragma once

#include "reference/run/result.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::reference {

/// At points of the body, one column per point; world frame.
struct PointValues {
  Eigen::Matrix3Xd displacement_m;
  Eigen::Matrix<double, 9, Eigen::Dynamic> stress_pa;  ///< Cauchy's, tension positive, a 3 x 3 matrix by columns
};

/// Minus the mean stress [Pa]: compression is positive.
[[nodiscard]] Eigen::RowVectorXd pressure_pa(const Eigen::Matrix<double, 9, Eigen::Dynamic>& stress_pa);
/// Von Mises' equivalent stress [Pa].
[[nodiscard]] Eigen::RowVectorXd von_mises_pa(const Eigen::Matrix<double, 9, Eigen::Dynamic>& stress_pa);

/// The scene's probes at one instant, in its order. The uncertainties are conservative half widths like those of force
/// and shape, NaN where these are unknown.
struct ProbeInstant {
  PointValues values;
  Eigen::VectorXd displacement_uncertainty_m;  ///< of the vector's length and of each component
  Eigen::VectorXd stress_uncertainty_pa;       ///< of each component: that of the tensor's Frobenius norm
  /// What that allows the pressure, 1 / sqrt(3) of it: differences of a single number vanish by chance.
  [[nodiscard]] Eigen::VectorXd pressure_uncertainty_pa() const { return stress_uncertainty_pa / std::sqrt(3.0); }
};

/// The solutions of a result. Where a point lies on the common side of several cells it has the mean of their stresses;
/// so has a point on the surface of an inclusion, where the exact stress jumps.
class Inside {
 public:
  virtual ~Inside() = default;

  /// On the finest mesh. @param points_m  3 x n, in the body at rest or on its surface, world frame
  [[nodiscard]] virtual PointValues at(const Eigen::Matrix3Xd& points_m, std::size_t instant) const = 0;

  /// Per instant. The uncertainty is 1.25 times the largest difference between the last three meshes, see
  /// uncertainty.h, and the change by each sensitivity at the probe itself, in proportion to the depth.
  [[nodiscard]] virtual std::vector<ProbeInstant> probes() const = 0;

  /// Displacement, stress, pressure and J - 1 in the cells of the finest mesh: the bytes of a VTU file. It holds what
  /// is solved: of a symmetric body a half, a quarter, or the meridian plane.
  [[nodiscard]] virtual std::string volume_file(std::size_t instant) const = 0;
};

/// @param store  the folder of Options, in which the result was found or put
/// @throws scene::InputError, also later, when the store has lost the solution
[[nodiscard]] std::unique_ptr<Inside> inside(const scene::Scene& scene, const Result& result,
                                             const std::filesystem::path& store);

}  // namespace touchstone::reference
