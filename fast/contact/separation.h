// How far the tool is from the body before they touch, and when they first do (section III, the first phase), by FCL on
// the triangles of both at rest.
//
// Not for the step: a distance takes FCL up to 0.8 ms, a query that finds contact takes memory from the heap, and
// triangles only approach the shapes. The step finds contact by itself, in every phase; this serves the records of a
// track. FCL's results for overlapping meshes (penetration depth, negative distance) or about
// a hierarchy that was refitted is wrong, so neither is used: hierarchies are built once, from the rest shapes.
#pragma once

#include "scene/base/frames.h"
#include "scene/model/scene.h"
#include "scene/shape/shape.h"
#include "scene/shape/surface.h"

#include <memory>
#include <optional>
#include <vector>

namespace touchstone::fast {

class Separation {
 public:
  /// Builds both hierarchies.
  /// @param body outlives this; @param body_surface its triangles, world frame; @param tool triangles, tool frame
  Separation(const scene::Shape& body, const scene::Surface& body_surface, const scene::Surface& tool);
  ~Separation();
  Separation(Separation&&) noexcept;
  Separation& operator=(Separation&&) noexcept;

  /// Least distance between the triangles of both [m]; zero when they touch, or the tool is inside the body.
  [[nodiscard]] double distance_m(const scene::Pose& pose) const;
  /// Triangles meet, or the tool is inside the body.
  [[nodiscard]] bool touches(const scene::Pose& pose) const;

  /// When the tool comes within tolerance_m of the body for the first time [s]; nothing if it never does. By
  /// conservative advancement: the tool is moved on only as far as none of its points can travel further than the
  /// distance that is left, so no contact is stepped over, however short.
  [[nodiscard]] std::optional<double> first_contact_s(const std::vector<scene::Waypoint>& track,
                                                      double tolerance_m = 1e-7) const;

 private:
  struct Hierarchies;
  std::unique_ptr<Hierarchies> hierarchies_;
};

}  // namespace touchstone::fast
