#include "fast/response/spread_load.h"

#include "fast/realtime/wide_loops.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

namespace touchstone::fast {

using scene::Vec3;

HalfSpace::HalfSpace(const scene::Material& material)
    : scale_m2_per_n(1.0 / (4.0 * std::numbers::pi * material.shear_modulus_pa())), nu(material.poissons_ratio) {}

double spread_pressure_pa(const SpreadLoad& load, const Vec3& x_m) noexcept {
  const Vec3 d_m = x_m - load.center_m;
  const double a_m = load.widening * load.radius_m, a2 = a_m * a_m, below_m = d_m.dot(load.normal);
  const double r2 = d_m.squaredNorm() - below_m * below_m;
  if (!(r2 < a2)) return 0.0;
  const double rim = std::sqrt(std::max(1.0 - r2 / a2, 1e-6));
  const double flat = load.field == nullptr ? load.flat : 0.0;  // under a ball the pressure ends in zero
  const double spread = 1.5 * (1.0 - flat) * rim + 0.5 * flat / rim;
  return load.force_n / (std::numbers::pi * a2) * ((1.0 - load.peaked) * spread + 2.5 * load.peaked * rim * rim * rim);
}

namespace {

/// What a ball's load adds near it.
Vec3 beside_ball_m(const SpreadLoad& load, const HalfSpace& half_space, const Vec3& across_m, double z) noexcept {
  if (load.field == nullptr) return Vec3::Zero();
  const double rho_m = std::sqrt(across_m.squaredNorm() + z * z), c2 = z * z / (rho_m * rho_m);
  if (!(rho_m > 0.0)) return Vec3::Zero();
  // Below the plane as the double force.
  const double k = 0.5 / (1.0 - half_space.nu);
  const auto [outward, up] = load.field->at(rho_m / (load.widening * load.radius_m), load.body_share);
  const double down = outward * k * z / rho_m * (2.0 * half_space.nu - 3.0 * c2) - up * (1.0 - c2);
  return load.field_m * (outward * (1.0 - 3.0 * k * c2) / rho_m * across_m - down * load.normal);
}

}  // namespace

Vec3 spread_displacement_m(const SpreadLoad& load, const HalfSpace& half_space, const Vec3& x_m) noexcept {
  const Vec3 d_m = x_m - load.center_m;
  const double z = std::max(-d_m.dot(load.normal), 0.0), a = load.radius_m;
  const Vec3 across_m = d_m + d_m.dot(load.normal) * -load.normal;
  const double r2 = across_m.squaredNorm(), beyond = r2 + z * z - a * a;
  const double root = std::sqrt(beyond * beyond + 4.0 * a * a * z * z);
  const double l2 = beyond > 0.0 ? 0.5 * (beyond + root) : (z > 0.0 ? 2.0 * a * a * z * z / (root - beyond) : 0.0);
  const double l = std::sqrt(l2), sum = a * a + l2;  // a^2 + l^2
  const double c = std::sqrt(std::max(1.0 - r2 / sum, 0.0));
  const double t = std::atan2(a, l);
  // Of the ball's pressure.
  const double I2 = (t - a * l / sum) / (a * a * a);
  const double z_I3 = z > 0.0 ? 2.0 / (a * a) * (c - z * t / a) : 0.0;  // z int ds / ((a^2 + s) s^(3/2)), z / l = c
  const double ball_V = 0.75 * (2.0 * t / a - r2 * I2 - z * z_I3);
  const double ball_Vz = -1.5 * z_I3, ball_Vr = -1.5 * I2;  // the latter over r
  const double ball_flux = 1.0 - c * c * c - 1.5 * z * r2 * I2;
  // Of the flat punch's.
  const double q = std::max(l2 + a * a * c * c, 1e-24 * a * a);
  const double punch_V = t / a, punch_Vz = -c / q, punch_Vr = -l / (sum * q);
  const double punch_flux = 1.0 - c;

  const double m = load.flat;
  const double V = ball_V + m * (punch_V - ball_V), Vz = ball_Vz + m * (punch_Vz - ball_Vz);
  const double Vr_per_r = ball_Vr + m * (punch_Vr - ball_Vr), flux = ball_flux + m * (punch_flux - ball_flux);
  const double scale_m2 = load.force_n * half_space.scale_m2_per_n;
  const double on_axis = (1.0 - m) * 1.5 * (1.0 / sum - z * I2) + m * 0.5 / sum;
  const double chi_r_per_r = r2 > 1e-9 * sum ? flux / r2 : on_axis;
  const double u_r_per_r = -scale_m2 * ((1.0 - 2.0 * half_space.nu) * chi_r_per_r + z * Vr_per_r);
  const double u_z = scale_m2 * (2.0 * (1.0 - half_space.nu) * V - z * Vz);
  Vec3 u_m = u_r_per_r * across_m - u_z * load.normal + beside_ball_m(load, half_space, across_m, z);
  const Vec3 Q_n = load.shear_n();
  if (Q_n.isZero(0.0)) return u_m;

  // Of the shear: int rho ds and int s^2 rho ds over the sources, rho the distance from z + is.
  using Complex = std::complex<double>;
  const Complex zeta(z, a), rho(l, a * c), line = zeta * rho + Complex(0.0, r2 * t);
  const double zeroth = line.imag();
  const double second =
      -2.0 *
      (0.25 * zeta * rho * rho * rho - r2 / 8.0 * line - 2.0 / 3.0 * z * rho * rho * rho + 0.5 * z * z * line).imag();
  const double punch_psi_r = z - zeroth / (2.0 * a);  // times r
  const double ball_psi_r = z - 0.75 / (a * a * a) * (a * a * zeroth - second);
  const bool off_axis = r2 > 1e-6 * sum;
  const double ball_axis = 1.5 * (1.0 / sum - z * I2), punch_axis = 0.5 / sum;
  const auto part = [&](const Vec3& f_n, double of_V, double of_Vz, double of_Vr, double of_flux, double axis,
                        double of_psi_r) -> Vec3 {
    const double chi_r = off_axis ? of_flux / r2 : axis, psi_r = off_axis ? of_psi_r / r2 : -0.5 * of_V;  // over r
    // (f_rr - f_r / r) / r^2 of psi and chi.
    const double psi_rr = off_axis ? (-2.0 * psi_r - of_V) / r2 : 0.0;
    const double chi_rr = off_axis ? (-2.0 * chi_r - of_Vz) / r2 : 0.0;
    const double x_n = f_n.dot(across_m), nu2 = 2.0 * half_space.nu;
    return (2.0 * of_V + nu2 * psi_r - z * chi_r) * f_n + x_n * (nu2 * psi_rr - z * chi_rr) * across_m -
           x_n * ((1.0 - nu2) * chi_r - z * of_Vr) * load.normal;
  };
  return u_m + half_space.scale_m2_per_n *
                   (part(load.ball_shear_n, ball_V, ball_Vz, ball_Vr, ball_flux, ball_axis, ball_psi_r) +
                    part(load.punch_shear_n, punch_V, punch_Vz, punch_Vr, punch_flux, punch_axis, punch_psi_r));
}

Vec3 spread_shear_pa(const SpreadLoad& load, const Vec3& x_m) noexcept {
  SpreadLoad one = load;
  one.force_n = 1.0;
  one.peaked = 0.0;
  one.field = nullptr;
  one.flat = 0.0;
  const double ball = spread_pressure_pa(one, x_m);
  one.flat = 1.0;
  return ball * load.ball_shear_n + spread_pressure_pa(one, x_m) * load.punch_shear_n;
}

namespace {

/// Adds the shear's displacement at all vertices: its second moment, far from it.
TOUCHSTONE_WIDE_LOOPS
void add_shear_m(const SpreadLoad& load, const HalfSpace& half_space, const Columns3& rest_m,
                 Columns3& out_m) noexcept {
  const std::size_t count = rest_m[0].size();
  const double a2 = load.radius_m * load.radius_m;
  const Vec3 force_n = half_space.scale_m2_per_n * load.shear_n();
  const Vec3 moment_n = half_space.scale_m2_per_n * 0.5 * a2 * (load.ball_shear_n / 5.0 + load.punch_shear_n / 3.0);
  const Eigen::Vector3f p = load.center_m.cast<float>(), n = load.normal.cast<float>(), f = force_n.cast<float>(),
                        m = moment_n.cast<float>();
  const float px = p.x(), py = p.y(), pz = p.z(), nx = n.x(), ny = n.y(), nz = n.z(), fx = f.x(), fy = f.y(),
              fz = f.z(), mx = m.x(), my = m.y(), mz = m.z();
  const auto nu2 = static_cast<float>(2.0 * half_space.nu), flat = 1.0f - nu2;
  const float* const x = rest_m[0].data();
  const float* const y = rest_m[1].data();
  const float* const z = rest_m[2].data();
  float* const ux = out_m[0].data();
  float* const uy = out_m[1].data();
  float* const uz = out_m[2].data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    const float below = -(dx * nx + dy * ny + dz * nz);
    const float rx = dx + below * nx, ry = dy + below * ny, rz = dz + below * nz;
    const float rho2 = dx * dx + dy * dy + dz * dz + 1e-12f;
    const float rho = std::sqrt(rho2), V = 1.0f / rho, V2 = V * V, V3 = V * V2, V5 = V3 * V2;
    const float near = 1.0f / (rho + below + 1e-9f), z_V = below * V;
    // The potentials of a point load along f, and their second derivatives along z for the moment along m.
    const float psi_r = -near, chi_r = V * near, psi_rr = V * near * near;
    const float chi_rr = -(2.0f + z_V) * V2 * near * near;
    const float V_zz = V3 * (3.0f * z_V * z_V - 1.0f), chi_r_zz = 3.0f * below * V5;
    const float Vr_zz = V5 * (3.0f - 15.0f * z_V * z_V);
    const float f_x = fx * rx + fy * ry + fz * rz, m_x = mx * rx + my * ry + mz * rz;
    const float f_own = 2.0f * V + nu2 * psi_r - below * chi_r;
    const float m_own = 2.0f * V_zz - nu2 * V3 - below * chi_r_zz;
    const float along =
        f_x * (nu2 * psi_rr - below * chi_rr) - m_x * (nu2 * 3.0f * V5 + below * 15.0f * below * V5 * V2);
    const float inward = f_x * (flat * chi_r + below * V3) - m_x * (flat * chi_r_zz - below * Vr_zz);
    ux[i] += f_own * fx - m_own * mx + along * rx - inward * nx;
    uy[i] += f_own * fy - m_own * my + along * ry - inward * ny;
    uz[i] += f_own * fz - m_own * mz + along * rz - inward * nz;
  }
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
std::int32_t spread_displacements_m(const SpreadLoad& load, const HalfSpace& half_space, const Columns3& rest_m,
                                    Columns3& out_m, std::int32_t* near) noexcept {
  const auto count = static_cast<std::int32_t>(rest_m[0].size());
  const float px = static_cast<float>(load.center_m.x()), py = static_cast<float>(load.center_m.y()),
              pz = static_cast<float>(load.center_m.z());
  const float nx = static_cast<float>(load.normal.x()), ny = static_cast<float>(load.normal.y()),
              nz = static_cast<float>(load.normal.z());
  const double a2 = load.radius_m * load.radius_m;
  const auto scale = static_cast<float>(load.force_n * half_space.scale_m2_per_n);
  const auto half_moment = static_cast<float>(0.5 * a2 * (0.2 + load.flat * (1.0 / 3.0 - 0.2)));
  const auto across = static_cast<float>(1.0 - 2.0 * half_space.nu);
  const auto along = static_cast<float>(2.0 * (1.0 - half_space.nu));
  const auto apart = static_cast<float>(load.apart_m3());
  const auto k = static_cast<float>(0.5 / (1.0 - half_space.nu)), nu2 = static_cast<float>(2.0 * half_space.nu);
  const auto near2 = static_cast<float>(near_radii * near_radii * a2);
  const float* const x = rest_m[0].data();
  const float* const y = rest_m[1].data();
  const float* const z = rest_m[2].data();
  float* const ux = out_m[0].data();
  float* const uy = out_m[1].data();
  float* const uz = out_m[2].data();
#pragma GCC ivdep
  for (std::int32_t i = 0; i < count; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    const float below = -(dx * nx + dy * ny + dz * nz);
    const float rx = dx + below * nx, ry = dy + below * ny, rz = dz + below * nz;
    const float rho2 = dx * dx + dy * dy + dz * dz + 1e-12f;
    const float rho = std::sqrt(rho2), by_rho = 1.0f / rho, by_rho2 = by_rho * by_rho, by_rho3 = by_rho * by_rho2;
    const float c2 = below * below * by_rho2;
    // 1/rho and its derivatives, less half_moment times their second ones along z.
    const float V = by_rho - half_moment * by_rho3 * (3.0f * c2 - 1.0f);
    const float Vz = -below * by_rho3 * (1.0f + half_moment * by_rho2 * (9.0f - 15.0f * c2));
    const float Vr_per_r = -by_rho3 * (1.0f + half_moment * by_rho2 * (3.0f - 15.0f * c2));
    const float chi_r_per_r = by_rho / (rho + below + 1e-9f) - half_moment * 3.0f * below * by_rho3 * by_rho2;
    const float A = apart * by_rho3;
    const float radial = A * (1.0f - 3.0f * k * c2) - scale * (across * chi_r_per_r + below * Vr_per_r);
    const float inward = A * k * below * (nu2 - 3.0f * c2) + scale * (along * V - below * Vz);
    ux[i] = radial * rx - inward * nx;
    uy[i] = radial * ry - inward * ny;
    uz[i] = radial * rz - inward * nz;
  }
  if (!load.shear_n().isZero(0.0)) add_shear_m(load, half_space, rest_m, out_m);
  // Most blocks have none, which wide registers find out sooner.
  constexpr std::int32_t block = 64;
  std::int32_t found = 0;
  for (std::int32_t begin = 0; begin < count; begin += block) {
    const std::int32_t end = std::min(begin + block, count);
    const auto is_near = [&](std::int32_t i) {
      const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
      return dx * dx + dy * dy + dz * dz < near2 ? 1 : 0;
    };
    std::int32_t here = 0;
    for (std::int32_t i = begin; i < end; ++i) here += is_near(i);
    for (std::int32_t i = begin; here > 0 && i < end; ++i) {
      near[found] = i;
      found += is_near(i);
    }
  }
  return found;
}

}  // namespace touchstone::fast
