#include "fast/skeleton/beam_stress.h"

#include "scene/base/index.h"

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

/// Axes x, y, z of a beam: y is towards the transverse force, or arbitrary if there is none.
Mat3 beam_axes(const Vec3& x, const Vec3& force_n) noexcept {
  Vec3 y = force_n - force_n.dot(x) * x;
  const double length = y.stableNorm();
  // A smaller component is round-off and gives no direction.
  if (length > 1e-12 * force_n.stableNorm()) {
    y /= length;
  } else {
    int least = 0;
    x.cwiseAbs().minCoeff(&least);
    y = Vec3::Unit(least).cross(x).normalized();
  }
  Mat3 axes;
  axes << x, y, x.cross(y);
  return axes;
}

/// Symmetric tensor of six components. @param shear factor of the off-diagonal components
Mat3 tensor(const SixComponents& c, double shear) noexcept {
  Mat3 t;
  t << c[0], shear * c[3], shear * c[5],  //
      shear * c[3], c[1], shear * c[4],   //
      shear * c[5], shear * c[4], c[2];
  return t;
}

}  // namespace

double centre_shear_factor(double poissons_ratio) noexcept {
  return (3.0 + 2.0 * poissons_ratio) / (2.0 * (1.0 + poissons_ratio));
}

Eigen::Matrix<double, 6, 6> inverse_elasticity_per_pa(double youngs_modulus_pa, double poissons_ratio) noexcept {
  Eigen::Matrix<double, 6, 6> inverse = Eigen::Matrix<double, 6, 6>::Zero();
  inverse.topLeftCorner<3, 3>().setConstant(-poissons_ratio);
  inverse.topLeftCorner<3, 3>().diagonal().setOnes();
  inverse.bottomRightCorner<3, 3>().diagonal().setConstant(2.0 * (1.0 + poissons_ratio));
  return inverse / youngs_modulus_pa;
}

void beam_stresses(const SkeletonView& view, const BeamEnds& ends, std::span<BeamStress> stress) noexcept {
  const Eigen::Matrix<double, 6, 6> inverse =
      inverse_elasticity_per_pa(view.skeleton.youngs_modulus_pa, view.skeleton.poissons_ratio);
  const double shear_factor = centre_shear_factor(view.skeleton.poissons_ratio);
  for (std::size_t i = 0; i < stress.size(); ++i) {
    BeamStress& end = stress[i];
    const Vec3& x = ends.beam[i].x;
    const Vec3& F_i = ends.force_n[i];
    end.axes = beam_axes(x, F_i);
    end.stress_pa = {
        F_i.dot(x) / view.area_m2[i], 0.0, 0.0, shear_factor * F_i.dot(end.axes.col(1)) / view.area_m2[i], 0.0, 0.0};
    Eigen::Map<Eigen::Matrix<double, 6, 1>>(end.strain.data()).noalias() =
        inverse.lazyProduct(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(end.stress_pa.data()));  // (8)
    end.stress_W_pa = end.axes * tensor(end.stress_pa, 1.0) * end.axes.transpose();
    end.strain_W = end.axes * tensor(end.strain, 0.5) * end.axes.transpose();
  }
}

Mat3 interpolated_stress_pa(std::span<const BeamStress> stress, const std::array<int, patch_corners_max>& patch_anchor,
                            const PatchPlace& place) noexcept {
  Mat3 sum = Mat3::Zero();
  for (std::size_t k = 0; k < patch_anchor.size(); ++k) {
    sum += place.weight[k] * nth(stress, patch_anchor[k]).stress_W_pa;
  }
  return sum;
}

Vec3 stress_force_n(const Mat3& stress_W_pa, const Vec3& normal, double area_m2) noexcept {
  return area_m2 * (stress_W_pa * normal);
}

}  // namespace touchstone::fast
