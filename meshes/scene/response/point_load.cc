#include "scene/response/point_load.h"

#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

/// Cylindrical coordinates about the load, z into the half space.
struct Place {
  double z, r, rho;
  Vec3 radial;  ///< unit length, zero on the axis
};

Place place(const PointLoad& load, const Vec3& x_m) {
  const Vec3 d_m = x_m - load.point_m;
  const double z = -d_m.dot(load.normal);
  const Vec3 across_m = d_m + z * load.normal;
  const double r = across_m.norm();
  return {z, r, d_m.norm(), r > 0.0 ? Vec3(across_m / r) : Vec3::Zero().eval()};
}

}  // namespace

Vec3 half_space_displacement_m(const PointLoad& load, const Material& material, const Vec3& x_m) {
  const double nu = material.poissons_ratio;
  const auto [z, r, rho, radial] = place(load, x_m);
  const double scale_m2 = load.force_n / (4.0 * std::numbers::pi * material.shear_modulus_pa());
  const double rho3 = rho * rho * rho, c2 = z * z / (rho * rho);
  const double apart_m3 = load.apart_nm / (4.0 * std::numbers::pi * material.shear_modulus_pa());
  const double u_r = scale_m2 * (r * z / rho3 - (1.0 - 2.0 * nu) * r / (rho * (rho + z))) +
                     apart_m3 * r / rho3 * (2.0 * (1.0 - nu) - 3.0 * c2);
  const double u_z = scale_m2 * (z * z / rho3 + 2.0 * (1.0 - nu) / rho) + apart_m3 * z / rho3 * (2.0 * nu - 3.0 * c2);
  Vec3 u_m = u_r * radial - u_z * load.normal;
  if (load.along_n.isZero(0.0)) return u_m;
  const double flat = (1.0 - 2.0 * nu) / (rho + z), x_n = r * load.along_n.dot(radial);
  const Vec3 d_m = r * radial - z * load.normal;
  const Vec3 along = (1.0 / rho + flat) * load.along_n +
                     x_n * (d_m / (rho * rho * rho) - flat / rho * (r / (rho + z) * radial + load.normal));
  return u_m + along / (4.0 * std::numbers::pi * material.shear_modulus_pa());
}

Mat3 half_space_stress_pa(const PointLoad& load, const Material& material, const Vec3& x_m) {
  const double nu = material.poissons_ratio;
  const auto [z, r, rho, radial] = place(load, x_m);
  const double scale_n = load.force_n / (2.0 * std::numbers::pi), rho5 = std::pow(rho, 5);
  const double flat = (1.0 - 2.0 * nu) / (rho * (rho + z));
  double rr = scale_n * (flat - 3.0 * r * r * z / rho5);
  double around = scale_n * ((1.0 - 2.0 * nu) * z / (rho * rho * rho) - flat);
  double zz = -3.0 * scale_n * z * z * z / rho5, rz = -3.0 * scale_n * r * z * z / rho5;
  if (load.apart_nm != 0.0) {
    const double apart_nm = load.apart_nm / (2.0 * std::numbers::pi), r2 = r * r / (rho * rho),
                 z2 = z * z / (rho * rho);
    const double by_rho3 = apart_nm / (rho * rho * rho), own = 2.0 * (1.0 - nu),
                 incompressible = 2.0 * nu * (3.0 * z2 - 1.0);
    rr += by_rho3 * (incompressible + own * (1.0 - 3.0 * r2) + z2 * (15.0 * r2 - 3.0));
    around += by_rho3 * (incompressible + own - 3.0 * z2);
    zz += by_rho3 * z2 * (15.0 * z2 - 9.0);
    rz += by_rho3 * r * z / (rho * rho) * (15.0 * z2 - 6.0);
  }
  const Vec3 down = -load.normal;
  const Vec3 side = r > 0.0 ? Vec3(down.cross(radial)) : down.unitOrthogonal();
  const Vec3 out = r > 0.0 ? radial : Vec3(side.cross(down));
  Mat3 stress_pa = rr * out * out.transpose() + around * side * side.transpose() + zz * down * down.transpose() +
                   rz * (out * down.transpose() + down * out.transpose());
  if (load.along_n.isZero(0.0)) return stress_pa;
  const double x_n = r * load.along_n.dot(radial), sum = rho + z;
  const Vec3 d_m = r * radial - z * load.normal, r_m = r * radial;
  const Mat3 across = Mat3::Identity() - load.normal * load.normal.transpose();
  Mat3 along = -3.0 * x_n / rho5 * d_m * d_m.transpose();
  along += (1.0 - 2.0 * nu) *
           (x_n / (rho * rho * rho) * across -
            (x_n * across + load.along_n * r_m.transpose() + r_m * load.along_n.transpose()) / (rho * sum * sum) +
            x_n * (1.0 / rho + 2.0 / sum) / (rho * rho * sum * sum) * r_m * r_m.transpose());
  return stress_pa + along / (2.0 * std::numbers::pi);
}

}  // namespace touchstone::scene
