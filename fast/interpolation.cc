#include "fast/interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr std::size_t corners = patch_corners_max;

/// Value of a quantity at p0 by the anchor points alone.
template <class Quantity>
Quantity at_p0(const std::array<Quantity, corners>& corner, const PatchPlace& place, Quantity sum) noexcept {
  for (std::size_t k = 0; k < corners; ++k) sum += place.weight[k] * corner[k];
  return sum;
}

/// The hat over the star of p0.
class Hat {
 public:
  Hat(const SurfacePatches& rest, const PatchPlace& p0) noexcept {
    for (std::size_t k = 0; k < corners; ++k) {
      edge_[k] = rest.edge[k].data();
      // p0 on an edge: the hat has no width on that side.
      inverse_[k] = static_cast<float>(1.0 / std::max(p0.edge[k], 1e-9));
    }
  }
  [[nodiscard]] float operator()(std::size_t v) const noexcept {
    const float e0 = edge_[0][v] * inverse_[0], e1 = edge_[1][v] * inverse_[1];
    const float e2 = edge_[2][v] * inverse_[2], e3 = edge_[3][v] * inverse_[3];
    const float a = e0 < e1 ? e0 : e1, b = e2 < e3 ? e2 : e3;
    // At most 1: away from p0 some edge comes nearer.
    return a < b ? a : b;
  }

 private:
  std::array<const float*, corners> edge_;
  std::array<float, corners> inverse_;
};

/// Sum of a patch quantity by weight at vertex v.
class Weighted {
 public:
  Weighted(const SurfacePatches& rest, const std::array<double, corners>& corner) noexcept {
    for (std::size_t k = 0; k < corners; ++k) {
      weight_[k] = rest.weight[k].data();
      corner_[k] = static_cast<float>(corner[k]);
    }
  }
  [[nodiscard]] float operator()(std::size_t v) const noexcept {
    return weight_[0][v] * corner_[0] + weight_[1][v] * corner_[1] + weight_[2][v] * corner_[2] +
           weight_[3][v] * corner_[3];
  }

 private:
  std::array<const float*, corners> weight_;
  std::array<float, corners> corner_;
};

std::array<double, corners> component(const std::array<Vec3, corners>& u, int axis) noexcept {
  std::array<double, corners> out{};
  for (std::size_t k = 0; k < corners; ++k) out[k] = u[k][axis];
  return out;
}

std::array<Vec3, corners> corner_displacements(const Patch& patch, const std::vector<Vec3>& anchor_m) noexcept {
  std::array<Vec3, corners> u;
  for (std::size_t k = 0; k < corners; ++k) u[k] = anchor_m[static_cast<std::size_t>(patch.anchor[k])];
  return u;
}

bool moves(const ContactPoint& contact, std::size_t patch) noexcept {
  return static_cast<std::size_t>(contact.patch) == patch && contact.displacement_m.squaredNorm() > 0.0;
}

double angle_to(const Vec3& direction, const Vec3& normal) noexcept {
  return std::atan2(direction.cross(normal).norm(), direction.dot(normal));
}

/// Angle of a displacement to the outward normal, `mean` standing in where nothing moves.
double displacement_angle(const Vec3& u_m, const Vec3& normal, const Vec3& mean_m) noexcept {
  return angle_to(u_m.squaredNorm() > 0.0 ? u_m : mean_m, normal);
}

/// cos and sin of an angle within 0 to pi by their series about pi/2, to 1e-7, so that the loop is vectorised.
struct CosSin {
  float cos, sin;
};
CosSin cos_sin(float angle) noexcept {
  const float x = angle - 0.5f * std::numbers::pi_v<float>, x2 = x * x;
  const float sine =
      x * (1.0f + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880 - x2 / 39916800)))));
  const float cosine = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320 - x2 / 3628800))));
  return {-sine, cosine};
}

}  // namespace

void interpolate_corrected(const SurfacePatches& rest, const std::vector<Vec3>& anchor_displacement_m,
                           const ContactPoint& contact, SurfaceField& field) noexcept {
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    for (int axis = 0; axis < 3; ++axis) {
      const Weighted weighted(rest, component(u, axis));
      float* out = field.displacement_m[static_cast<std::size_t>(axis)].data();
      // Columns never overlap.
#pragma GCC ivdep
      for (std::size_t v = begin; v < end; ++v) out[v] = weighted(v);
    }
    if (!moves(contact, p)) continue;
    const Hat hat(rest, contact.place);
    const Eigen::Vector3f rise = (contact.displacement_m - at_p0(u, contact.place, Vec3(Vec3::Zero()))).cast<float>();
    float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
#pragma GCC ivdep
    for (std::size_t v = begin; v < end; ++v) {
      const float height = hat(v);
      x[v] += height * rise.x();
      y[v] += height * rise.y();
      z[v] += height * rise.z();
    }
  }
}

void interpolate_published(const SurfacePatches& rest, const std::vector<Vec3>& anchor_displacement_m,
                           const ContactPoint& contact, SurfaceField& field) noexcept {
  for (std::size_t p = 0; p < rest.patches.size(); ++p) {
    const Patch& patch = rest.patches[p];
    const std::array<Vec3, corners> u = corner_displacements(patch, anchor_displacement_m);
    const bool touched = moves(contact, p);
    Vec3 mean_m = touched ? contact.displacement_m : Vec3(Vec3::Zero());
    for (std::size_t k = 0; k < patch.corners; ++k) mean_m += u[k];

    std::array<double, corners> length{}, angle{};
    for (std::size_t k = 0; k < corners; ++k) {
      length[k] = u[k].norm();
      angle[k] = displacement_angle(u[k], patch.corner_normal[k], mean_m);
    }
    const Weighted length_at(rest, length), angle_at(rest, angle);
    // Without a contact point on this patch the hat has no height.
    const Hat hat(rest, contact.place);
    float length_rise = 0.0f, angle_rise = 0.0f;
    if (touched) {
      length_rise = static_cast<float>(contact.displacement_m.norm() - at_p0(length, contact.place, 0.0));
      angle_rise =
          static_cast<float>(angle_to(contact.displacement_m, contact.normal) - at_p0(angle, contact.place, 0.0));
    }
    const Eigen::Vector3f toward = mean_m.stableNormalized().cast<float>();
    const float *nx = rest.normal[0].data(), *ny = rest.normal[1].data(), *nz = rest.normal[2].data();
    float* x = field.displacement_m[0].data();
    float* y = field.displacement_m[1].data();
    float* z = field.displacement_m[2].data();
    const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
    // Columns never overlap.
#pragma GCC ivdep
    for (std::size_t v = begin; v < end; ++v) {
      const float height = hat(v);
      const float raised_length = length_at(v) + height * length_rise, raised_angle = angle_at(v) + height * angle_rise;
      const float magnitude = raised_length > 0.0f ? raised_length : 0.0f;
      const float not_negative = raised_angle > 0.0f ? raised_angle : 0.0f;
      const float theta = not_negative < std::numbers::pi_v<float> ? not_negative : std::numbers::pi_v<float>;
      // Unit tangent towards the mean displacement; none where that is along the normal.
      const float along = toward.x() * nx[v] + toward.y() * ny[v] + toward.z() * nz[v];
      const float tx = toward.x() - along * nx[v], ty = toward.y() - along * ny[v], tz = toward.z() - along * nz[v];
      const float tangent2 = tx * tx + ty * ty + tz * tz;
      const float inverse = 1.0f / std::sqrt(tangent2 + 1e-20f);
      const float to_unit = tangent2 > 1e-10f ? inverse : 0.0f;
      const CosSin turn = cos_sin(theta);
      const float out = magnitude * turn.cos, aside = magnitude * turn.sin * to_unit;
      x[v] = out * nx[v] + aside * tx;
      y[v] = out * ny[v] + aside * ty;
      z[v] = out * nz[v] + aside * tz;
    }
  }
}

}  // namespace touchstone::fast
