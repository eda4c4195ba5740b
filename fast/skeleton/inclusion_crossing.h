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

inline constexpr std::size_t inclusions_max = 16;
inline constexpr std::size_t segments_max = 2 * inclusions_max + 1;

/// A part of the body of another material, at its place at rest.
struct Inclusion {
  std::shared_ptr<const scene::Shape> shape;
  double youngs_modulus_pa = 0.0;
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
