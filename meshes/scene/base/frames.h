// Geometry words shared by both solvers. Frames: W is the world, its origin at the centre of the
// body's lowest plane, z up (the paper puts it at the bottom centre of the body); T is the tool,
// its origin at the tool's mass centre. A name like p_W_m is a point in world coordinates, in metres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace touchstone::scene {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Place and orientation of the tool frame in the world: p_W = orientation * p_T + position_m.
struct Pose {
  Vec3 position_m = Vec3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// Axis-aligned box in world coordinates [m].
struct Bounds {
  Vec3 lower_m = Vec3::Zero();
  Vec3 upper_m = Vec3::Zero();
};

}  // namespace touchstone::scene
