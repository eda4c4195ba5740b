// Bullet's deformable body under the same press, for comparison. This header includes nothing of Bullet.
#pragma once

#include "scene/base/frames.h"

#include <memory>
#include <string>

namespace touchstone::bench {

/// A block of neo-Hookean tetrahedra with its base held, a rigid ball pressed on its top, one implicit or explicit
/// step a tick. Every cell of a regular grid is cut into five tetrahedra, so that the surface has 12 n^2 triangles.
struct BulletScene {
  int cells = 9;                ///< n, along every edge
  double edge_m = 0.06;         ///< of the block, which is centred on the z axis with its base at z = 0
  double ball_radius_m = 0.01;  ///< of the tool
  double youngs_modulus_pa = 3.0e6;
  double poissons_ratio = 0.45;  ///< Bullet's tetrahedra cannot be incompressible
  double density_kg_per_m3 = 1000.0;
  double step_s = 1.0e-3;
  bool implicit = true;
};

/// "Bullet 3.24"
[[nodiscard]] std::string bullet_version();

class BulletPeer {
 public:
  explicit BulletPeer(const BulletScene& scene);
  ~BulletPeer();
  BulletPeer(const BulletPeer&) = delete;
  BulletPeer& operator=(const BulletPeer&) = delete;

  /// Moves the ball's centre there within one step and makes the step.
  void step(const scene::Vec3& ball_center_m);

  [[nodiscard]] int surface_triangles() const noexcept;
  [[nodiscard]] int tetrahedra() const noexcept;
  /// Rest place of the top node nearest to the middle of the top, the one to press on.
  [[nodiscard]] scene::Vec3 top_node_m() const noexcept;
  /// Every node has a finite position within twice the block's edge of its rest position.
  [[nodiscard]] bool sound() const noexcept;
  /// Displacement at points of the block at rest, 3 x n: trilinear between the nodes of the grid.
  [[nodiscard]] Eigen::Matrix3Xd displacement_m(const Eigen::Matrix3Xd& rest_points_m) const;
  /// How far that node has gone down [m].
  [[nodiscard]] double dent_m() const noexcept;
  /// Depth of the deepest node inside the ball [m]; 0 if there is none.
  [[nodiscard]] double pierced_m() const noexcept;
  /// Contacts of the last step.
  [[nodiscard]] int contacts() const noexcept;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace touchstone::bench
