// Mesh tools made from shapes.
#pragma once

#include "scene/mesh/mesh_checks.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <memory>

namespace touchstone::test {

inline Eigen::Quaterniond turned(double angle, const scene::Vec3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// A shape's triangles as one closed mesh.
inline std::shared_ptr<const scene::TriangleMesh> mesh_of(const scene::Shape& shape, int triangles) {
  const scene::Surface surface = scene::tessellate(shape, triangles);
  scene::RawMesh raw;
  for (const auto& p_m : surface.points_m.colwise()) raw.points.emplace_back(p_m);
  raw.triangles = surface.triangles;
  raw = scene::welded(raw);
  auto mesh = std::make_shared<scene::TriangleMesh>();
  mesh->points_m.resize(3, static_cast<Eigen::Index>(raw.points.size()));
  for (std::size_t i = 0; i < raw.points.size(); ++i) mesh->points_m.col(static_cast<Eigen::Index>(i)) = raw.points[i];
  mesh->triangles = raw.triangles;
  return mesh;
}

inline scene::Tool mesh_tool(const scene::Shape& shape, int triangles) {
  scene::Tool tool;
  tool.shape = scene::ToolShape::mesh;
  tool.mesh = mesh_of(shape, triangles);
  tool.mass_center_m = scene::Vec3::Zero();
  return tool;
}

}  // namespace touchstone::test
