// The depth of one tool in one body at many poses.
#pragma once

#include "scene/model/scene.h"

#include <memory>

namespace touchstone::scene {

/// As rest_depth_m() and gap_m(), to the same tolerance. A mesh is prepared once, which takes as long as some ten of
/// those; then a pose takes a few microseconds where few triangles are near the deepest place, and no longer than
/// those where all are.
class RestDepth {
 public:
  /// @param body, tool  outlive it
  RestDepth(const Shape& body, const Tool& tool);
  ~RestDepth();
  [[nodiscard]] double depth_m(const Pose& pose) const;
  [[nodiscard]] double gap_m(const Pose& pose) const;

 private:
  struct MeshInBoxes;
  [[nodiscard]] double least_m(const Pose& pose, double enough) const;

  const Shape& body_;
  const Tool& tool_;
  std::unique_ptr<const MeshInBoxes> mesh_;  ///< of a mesh tool
};

}  // namespace touchstone::scene
