// Where a beam's centre line runs through the body's inclusions, section V-D.
#pragma once

#include "fast/skeleton/beam.h"
#include "scene/model/scene.h"

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace touchstone::fast {

/// The part of a straight line inside a shape, as distances from the line's beginning [m]; none where leave <= enter.
struct Crossing {
  double enter_m = 0.0, leave_m = 0.0;

  [[nodiscard]] bool empty() const noexcept { return !(leave_m > enter_m); }
};

/// The part of the line between two points that lies inside a convex shape. Free of heap use.
using Cross = Crossing (*)(const scene::Shape& shape, const scene::Vec3& from_m, const scene::Vec3& to_m) noexcept;

/// By the shape's exact signed distance alone, which is convex along a line: its least value by the tangents at both
/// ends, then Newton's method from outside on either side, where it never overshoots. To 1e-12 of the line's length.
[[nodiscard]] Crossing cross_convex(const scene::Shape&, const scene::Vec3& from_m, const scene::Vec3& to_m) noexcept;

/// The closed form of the shape, or cross_convex() where there is none.
[[nodiscard]] Cross crossing_of(const scene::Shape& shape) noexcept;

inline constexpr std::size_t inclusions_max = 16;
inline constexpr std::size_t segments_max = 2 * inclusions_max + 1;

/// A part of the body of another material, at its place at rest.
struct Inclusion {
  std::shared_ptr<const scene::Shape> shape;
  double youngs_modulus_pa = 0.0;
  Cross cross = nullptr;
};

/// The body's inclusions, in the scene's order; at most inclusions_max, which the scene's rules see to.
[[nodiscard]] std::vector<Inclusion> inclusions_of(const scene::Body& body);

/// A beam's segments from its anchor point to the contact.
struct BeamSegments {
  std::array<BeamSegment, segments_max> segment;
  std::size_t count = 0;

  [[nodiscard]] std::span<const BeamSegment> all() const noexcept { return {segment.data(), count}; }
};

/// What a beam is made of, besides its place.
struct BeamMaterial {
  double length_m = 0.0;           ///< l; longer than the line inside R, and every segment in proportion (errata E9)
  double youngs_modulus_pa = 0.0;  ///< outside the inclusions
  double area_m2 = 0.0;
};

/// Cuts the beam at the inclusions' surfaces. Scenes keep inclusions apart; were they to overlap, the later one would
/// count. Inclusions stay at their place at rest, also under a line that runs on the deformed body.
[[nodiscard]] BeamSegments cut_beam(std::span<const Inclusion> inclusions, const scene::Vec3& anchor_m,
                                    const scene::Vec3& contact_m, const BeamMaterial& beam) noexcept;

}  // namespace touchstone::fast
