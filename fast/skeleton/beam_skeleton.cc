#include "fast/skeleton/beam_skeleton.h"

#include "fast/skeleton/beam.h"
#include "fast/skeleton/beam_areas.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

/// Geometry of beam i, without its stiffnesses.
Beam line_to(const SkeletonView& view, std::size_t i, const Vec3& p0_W_m, const Vec3& force_direction) noexcept {
  const Vec3 along_m = p0_W_m - view.anchor_m[i];
  const double distance_m = along_m.norm();
  Beam beam;
  beam.l_m = std::max(distance_m, view.skeleton.r_R_m);  // E9
  beam.x = distance_m < 1e-9 ? force_direction : Vec3(along_m / distance_m);
  return beam;
}

/// Computes beam i of a contact; one of the functions below.
using BeamTo = Beam (*)(const SkeletonView&, std::size_t i, const Vec3& p0_W_m, const Vec3& force_direction) noexcept;

Beam beam_to(const SkeletonView& view, std::size_t i, const Vec3& p0_W_m, const Vec3& force_direction) noexcept {
  Beam beam = line_to(view, i, p0_W_m, force_direction);
  const BeamSegment segment{beam.l_m, view.skeleton.youngs_modulus_pa, view.area_m2[i],
                            second_moment_m4(view.area_m2[i])};
  beam.axial_n_per_m = 1.0 / axial_compliance_m_per_n({&segment, 1});
  beam.bending_n_per_m = 1.0 / bending_compliance_m_per_n({&segment, 1});
  return beam;
}

BeamSegments parts_of(const SkeletonView& view, std::size_t i, const Vec3& p0_W_m, const Beam& beam) noexcept {
  return cut_beam(view.skeleton.inclusions, view.anchor_m[i], p0_W_m,
                  {beam.l_m, view.skeleton.youngs_modulus_pa, view.area_m2[i]});
}

Beam beam_in_parts_published(const SkeletonView& view, std::size_t i, const Vec3& p0_W_m,
                             const Vec3& force_direction) noexcept {
  Beam beam = line_to(view, i, p0_W_m, force_direction);
  const BeamSegments parts = parts_of(view, i, p0_W_m, beam);
  beam.axial_n_per_m = 1.0 / printed_axial_compliance_m_per_n(parts.all());
  beam.bending_n_per_m = 1.0 / printed_bending_compliance_m_per_n(parts.all());
  return beam;
}

Beam beam_in_parts_corrected(const SkeletonView& view, std::size_t i, const Vec3& p0_W_m,
                             const Vec3& force_direction) noexcept {
  Beam beam = line_to(view, i, p0_W_m, force_direction);
  const BeamSegments parts = parts_of(view, i, p0_W_m, beam);
  const double bending_m_per_n = bending_compliance_m_per_n(parts.all());
  beam.axial_n_per_m = 1.0 / axial_compliance_m_per_n(parts.all());
  beam.bending_n_per_m = 1.0 / bending_m_per_n;
  beam.release_ratio = released_bending_compliance_m_per_n(parts.all()) / bending_m_per_n;
  return beam;
}

/// Sets the anchor point's displacement, limited to limit_m; fixed anchor points do not move.
void move_anchor(const BeamSkeleton& skeleton, std::size_t i, const Vec3& displacement_m, double limit_m,
                 BeamEnds& ends) noexcept {
  if (skeleton.held[i]) return;
  const double length_m = displacement_m.norm();
  if (length_m <= limit_m) {
    ends.displacement_m[i] = displacement_m;
    return;
  }
  // stableNormalized: the length itself may have overflowed.
  ends.displacement_m[i] = limit_m * displacement_m.stableNormalized();
  ends.limited = true;
}

/// a, b >= 0 that minimise |a g + b h - F|, of minimum norm where g and h are parallel.
struct ScaleFactors {
  double a = 0.0, b = 0.0;
};
ScaleFactors scale_factors(const Vec3& g, const Vec3& h, const Vec3& F) noexcept {
  const double gg = g.squaredNorm(), hh = h.squaredNorm(), gh = g.dot(h);
  const double gF = g.dot(F), hF = h.dot(F);
  ScaleFactors both;
  const double determinant = g.cross(h).squaredNorm();
  if (determinant > 1e-12 * gg * hh) {
    both = {(hh * gF - gh * hF) / determinant, (gg * hF - gh * gF) / determinant};
  } else if (gg + hh > 0.0) {
    both = {gF / (gg + hh), hF / (gg + hh)};
  }
  if (both.a >= 0.0 && both.b >= 0.0) return both;
  // With one factor at its bound: the better of both cases.
  const ScaleFactors only_a{gg > 0.0 ? std::max(0.0, gF / gg) : 0.0, 0.0};
  const ScaleFactors only_b{0.0, hh > 0.0 ? std::max(0.0, hF / hh) : 0.0};
  return (only_a.a * g - F).squaredNorm() <= (only_b.b * h - F).squaredNorm() ? only_a : only_b;
}

template <BeamTo beam_of>
void split_published(const SkeletonView& view, const Vec3& p0_W_m, const Vec3& force_n, const Vec3& displacement_m,
                     BeamEnds& ends) noexcept {
  ends.clear();
  const double F = force_n.norm(), D = displacement_m.norm();
  if (!(F > 0.0) || !(D > 0.0)) return;
  const double E = view.skeleton.youngs_modulus_pa;
  const std::size_t beams = view.anchor_m.size();
  // First pass: g and h are the sums of (6) for a = b = 1.
  Vec3 g = Vec3::Zero(), h = Vec3::Zero();
  for (std::size_t i = 0; i < beams; ++i) {
    const Beam& beam = ends.beam[i] = beam_of(view, i, p0_W_m, force_n / F);
    const double along_m = displacement_m.dot(beam.x);
    const Vec3 across_m = displacement_m - along_m * beam.x;  // y'_i along y_i
    // E19: delta x = l - l^2 / sqrt(l^2 + y'^2), in a form without cancellation.
    const double l = beam.l_m, bent_m = std::hypot(l, across_m.norm());
    const double delta_x_m = l * across_m.squaredNorm() / (bent_m * (bent_m + l));
    const Vec3 Delta_x_m = (along_m + delta_x_m) * beam.x;
    // The factors a and b contain E and 3 E of the body's own material.
    ends.force_n[i] = Delta_x_m * (beam.axial_n_per_m / E);                  // (4), (13)
    ends.displacement_m[i] = across_m * (beam.bending_n_per_m / (3.0 * E));  // (5), (14)
    g += ends.force_n[i];
    h += ends.displacement_m[i];
  }
  const auto [a, b] = scale_factors(g, h, force_n);
  for (std::size_t i = 0; i < beams; ++i) {
    const Beam& beam = ends.beam[i];
    const Vec3 F_x = a * ends.force_n[i], F_y = b * ends.displacement_m[i];
    ends.force_n[i] = F_x + F_y;
    ends.displacement_m[i].setZero();
    move_anchor(view.skeleton, i, F_x / beam.axial_n_per_m + F_y / beam.bending_n_per_m, D, ends);
  }
}

template <BeamTo beam_of>
void split_corrected(const SkeletonView& view, const Vec3& p0_W_m, const Vec3& force_n, const Vec3& displacement_m,
                     BeamEnds& ends) noexcept {
  ends.clear();
  const double F = force_n.norm(), D = displacement_m.norm();
  if (!(F > 0.0) || !(D > 0.0)) return;
  const std::size_t beams = view.anchor_m.size();
  const auto K_i = [](const Beam& beam) {
    return Mat3(beam.bending_n_per_m * Mat3::Identity() +
                (beam.axial_n_per_m - beam.bending_n_per_m) * beam.x * beam.x.transpose());
  };
  Mat3 K = Mat3::Zero();
  for (std::size_t i = 0; i < beams; ++i) {
    ends.beam[i] = beam_of(view, i, p0_W_m, force_n / F);
    K += K_i(ends.beam[i]);
  }
  // Scaled by the mean stiffness and by F, so that no value of s_c leads to overflow.
  const double stiffness_n_per_m = K.trace() / 3.0;
  const Vec3 u = (K / stiffness_n_per_m).ldlt().solve(force_n / F);
  for (std::size_t i = 0; i < beams; ++i) {
    const Beam& beam = ends.beam[i];
    ends.force_n[i] = F * (K_i(beam) / stiffness_n_per_m * u);
    const Vec3 released = u + (beam.release_ratio - 1.0) * (u - u.dot(beam.x) * beam.x);  // E10
    move_anchor(view.skeleton, i, (F / stiffness_n_per_m) * released, D, ends);
  }
}

}  // namespace

BeamEnds::BeamEnds(std::size_t beams)
    : force_n(beams, Vec3::Zero()), displacement_m(beams, Vec3::Zero()), beam(beams) {}

void BeamEnds::clear() noexcept {
  std::fill(force_n.begin(), force_n.end(), Vec3::Zero());
  std::fill(displacement_m.begin(), displacement_m.end(), Vec3::Zero());
  limited = false;
}

BeamSkeleton beam_skeleton(const AnchorPoints& anchors, const scene::Scene& scene) {
  BeamSkeleton skeleton;
  skeleton.anchor_m = anchors.points_m();
  skeleton.held = anchors.held();
  skeleton.triangles = area_triangles(anchors);
  skeleton.youngs_modulus_pa = scene.body.material.youngs_modulus_pa;
  skeleton.poissons_ratio = scene.body.material.poissons_ratio;
  skeleton.inclusions = inclusions_of(scene.body);
  skeleton.set_constants(scene.fast);
  return skeleton;
}

void BeamSkeleton::set_constants(const scene::FastSettings& fast) {
  s_c_m2 = fast.s_c_m2;
  area_m2 = voronoi_shares(triangles);
  for (double& area : area_m2) area *= s_c_m2;
  r_R_m = fast.r_R_m;
}

CurrentEnds::CurrentEnds(const BeamSkeleton& skeleton) : anchor_m(skeleton.anchor_m), area_m2(skeleton.area_m2) {}

void CurrentEnds::update(const BeamSkeleton& skeleton, std::span<const Vec3> anchor_displacement_m) noexcept {
  for (std::size_t i = 0; i < anchor_m.size(); ++i) anchor_m[i] = skeleton.anchor_m[i] + anchor_displacement_m[i];
  voronoi_shares(skeleton.triangles, anchor_displacement_m, area_m2);
  for (double& area : area_m2) area *= skeleton.s_c_m2;  // (19)
}

SplitForce split_force_of(scene::Formulation formulation, const BeamSkeleton& skeleton) noexcept {
  const bool one_material = skeleton.inclusions.empty();
  if (formulation == scene::Formulation::published) {
    return one_material ? split_force_published : split_force_in_parts_published;
  }
  return one_material ? split_force_corrected : split_force_in_parts_corrected;
}

const SplitForce split_force_published = split_published<beam_to>;
const SplitForce split_force_corrected = split_corrected<beam_to>;
const SplitForce split_force_in_parts_published = split_published<beam_in_parts_published>;
const SplitForce split_force_in_parts_corrected = split_corrected<beam_in_parts_corrected>;

Vec3 support_force_n(const BeamEnds& ends) noexcept {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& F_i : ends.force_n) sum -= F_i;
  return sum;
}

}  // namespace touchstone::fast
