#include "fast/bench/bullet_peer.h"

#include "scene/base/index.h"

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace touchstone::bench {
namespace {

using scene::Vec3;

/// Bullet computes in metres. Its tolerances are absolute: in centimetres its solver takes more iterations for the same
/// result.
constexpr double unit_m = 1.0;

/// Damping: stress per strain rate, over the modulus. With a tenth of it Bullet's rubber is unstable at steps of 1 ms.
constexpr double damping_s = 0.01;

btVector3 to_bullet(const Vec3& v_m) {
  return {static_cast<btScalar>(v_m.x() / unit_m), static_cast<btScalar>(v_m.y() / unit_m),
          static_cast<btScalar>(v_m.z() / unit_m)};
}

Vec3 from_bullet(const btVector3& v) { return unit_m * Vec3(v.x(), v.y(), v.z()); }

/// Five tetrahedra of a cell by its corners (bit 0: x, bit 1: y, bit 2: z). Neighbouring cells alternate with the
/// mirror image, so that the diagonals of a common face agree.
constexpr std::array<std::array<int, 4>, 5> even_cell = {
    {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}}};

}  // namespace

struct BulletPeer::World {
  BulletScene scene;
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver body_solver;
  btDeformableMultiBodyConstraintSolver constraint_solver;
  std::unique_ptr<btDeformableMultiBodyDynamicsWorld> dynamics;
  std::unique_ptr<btSphereShape> ball_shape;
  std::unique_ptr<btRigidBody> ball;
  std::unique_ptr<btDeformableNeoHookeanForce> force;
  std::unique_ptr<btSoftBody> body;
  std::vector<Vec3> rest_m;
  int top_middle = 0;

  explicit World(const BulletScene& s) : scene(s) {
    constraint_solver.setDeformableSolver(&body_solver);
    dynamics = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher, &broadphase, &constraint_solver,
                                                                    &configuration, &body_solver);
    dynamics->setGravity({0, 0, 0});
    btSoftBodyWorldInfo& info = dynamics->getWorldInfo();
    info.m_gravity = {0, 0, 0};
    // A voxel of the distance grid must resolve the ball, or nodes pass through it.
    info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(0.1 * s.ball_radius_m / unit_m));
    info.m_sparsesdf.Reset();
    add_ball();
    add_body();
    dynamics->setImplicit(s.implicit);
    dynamics->setLineSearch(false);
    dynamics->setUseProjection(true);
    btContactSolverInfo& solver = dynamics->getSolverInfo();
    solver.m_deformable_erp = 0.3f;
    solver.m_deformable_maxErrorReduction = 200.0f;
    solver.m_leastSquaresResidualThreshold = 1e-3f;
    solver.m_splitImpulse = true;
    solver.m_numIterations = 100;
  }

  ~World() {
    // The world keeps pointers to both, so they are removed before they are deleted.
    dynamics->removeSoftBody(body.get());
    dynamics->removeRigidBody(ball.get());
  }

  void add_ball() {
    ball_shape = std::make_unique<btSphereShape>(static_cast<btScalar>(scene.ball_radius_m / unit_m));
    ball = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, ball_shape.get()));
    ball->setCollisionFlags(ball->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    ball->setActivationState(DISABLE_DEACTIVATION);
    ball->setFriction(0);
    place({0, 0, scene.edge_m + 2.0 * scene.ball_radius_m}, Vec3::Zero());
    dynamics->addRigidBody(ball.get());
  }

  void place(const Vec3& center_m, const Vec3& velocity_m_per_s) {
    const btTransform transform(btQuaternion::getIdentity(), to_bullet(center_m));
    ball->setWorldTransform(transform);
    ball->setInterpolationWorldTransform(transform);
    ball->setLinearVelocity(to_bullet(velocity_m_per_s));
  }

  void add_body() {
    const int n = scene.cells;
    const double h = scene.edge_m / n;
    const auto index = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
    std::vector<btVector3> nodes;
    for (int k = 0; k <= n; ++k) {
      for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
          rest_m.emplace_back(i * h - 0.5 * scene.edge_m, j * h - 0.5 * scene.edge_m, k * h);
          nodes.push_back(to_bullet(rest_m.back()));
        }
      }
    }
    top_middle = index(n / 2, n / 2, n);
    body =
        std::make_unique<btSoftBody>(&dynamics->getWorldInfo(), static_cast<int>(nodes.size()), nodes.data(), nullptr);
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) add_cell(index, i, j, k);
      }
    }
    btSoftBodyHelpers::generateBoundaryFaces(body.get());
    body->initializeDmInverse();
    body->m_tetraScratches.resize(body->m_tetras.size());
    body->m_tetraScratchesTn.resize(body->m_tetras.size());
    body->getCollisionShape()->setMargin(static_cast<btScalar>(1e-4 / unit_m));
    body->setTotalMass(static_cast<btScalar>(scene.density_kg_per_m3 * std::pow(scene.edge_m, 3)), false);
    for (int i = 0; i < (n + 1) * (n + 1); ++i) body->setMass(i, 0);
    body->m_cfg.kKHR = 1;
    body->m_cfg.kCHR = 1;
    body->m_cfg.kDF = 0;
    body->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    body->m_sleepingThreshold = 0;
    dynamics->addSoftBody(body.get());
    const double modulus = scene.youngs_modulus_pa * unit_m;  // kg / (unit s^2)
    const double nu = scene.poissons_ratio;
    force = std::make_unique<btDeformableNeoHookeanForce>(
        static_cast<btScalar>(modulus / (2 * (1 + nu))),
        static_cast<btScalar>(modulus * nu / ((1 + nu) * (1 - 2 * nu))), static_cast<btScalar>(damping_s));
    dynamics->addForce(body.get(), force.get());
  }

  template <class Index>
  void add_cell(const Index& index, int i, int j, int k) {
    const int mirror = (i + j + k) % 2;
    for (const auto& corners : even_cell) {
      std::array<int, 4> node{};
      for (std::size_t c = 0; c < 4; ++c) {
        const int corner = corners[c] ^ mirror;
        node[c] = index(i + (corner & 1), j + ((corner >> 1) & 1), k + ((corner >> 2) & 1));
      }
      // Mirrored tetrahedra have the opposite orientation; swap two nodes.
      const Vec3 a = nth(rest_m, node[1]) - nth(rest_m, node[0]);
      const Vec3 b = nth(rest_m, node[2]) - nth(rest_m, node[0]);
      const Vec3 c = nth(rest_m, node[3]) - nth(rest_m, node[0]);
      if (a.cross(b).dot(c) < 0.0) std::swap(node[2], node[3]);
      body->appendTetra(node[0], node[1], node[2], node[3]);
      // Without links Bullet's tree of the nodes never terminates.
      for (int first = 0; first < 4; ++first) {
        for (int second = first + 1; second < 4; ++second) {
          body->appendLink(nth(node, first), nth(node, second), nullptr, true);
        }
      }
    }
  }
};

std::string bullet_version() {
  return "Bullet " + std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
}

BulletPeer::BulletPeer(const BulletScene& scene) : world_(std::make_unique<World>(scene)) {}
BulletPeer::~BulletPeer() = default;

void BulletPeer::step(const Vec3& ball_center_m) {
  World& w = *world_;
  const Vec3 before_m = from_bullet(w.ball->getWorldTransform().getOrigin());
  w.place(ball_center_m, (ball_center_m - before_m) / w.scene.step_s);
  const auto step_s = static_cast<btScalar>(w.scene.step_s);
  w.dynamics->stepSimulation(step_s, 1, step_s);
}

int BulletPeer::surface_triangles() const noexcept { return world_->body->m_faces.size(); }
int BulletPeer::tetrahedra() const noexcept { return world_->body->m_tetras.size(); }

Vec3 BulletPeer::top_node_m() const noexcept { return nth(world_->rest_m, world_->top_middle); }

bool BulletPeer::sound() const noexcept {
  const auto& nodes = world_->body->m_nodes;
  for (int i = 0; i < nodes.size(); ++i) {
    const Vec3 moved_m = from_bullet(nodes[i].m_x) - nth(world_->rest_m, i);
    if (!moved_m.allFinite() || moved_m.norm() > 2.0 * world_->scene.edge_m) return false;
  }
  return true;
}

Eigen::Matrix3Xd BulletPeer::displacement_m(const Eigen::Matrix3Xd& rest_points_m) const {
  const int n = world_->scene.cells;
  const double h = world_->scene.edge_m / n;
  Eigen::Matrix3Xd u_m = Eigen::Matrix3Xd::Zero(3, rest_points_m.cols());
  for (Eigen::Index k = 0; k < rest_points_m.cols(); ++k) {
    const Vec3 at = (rest_points_m.col(k) - world_->rest_m.front()) / h;
    std::array<int, 3> cell{};
    Vec3 in_cell;
    for (int axis = 0; axis < 3; ++axis) {
      nth(cell, axis) = std::clamp(static_cast<int>(std::floor(at[axis])), 0, n - 1);
      in_cell[axis] = std::clamp(at[axis] - nth(cell, axis), 0.0, 1.0);
    }
    for (int corner = 0; corner < 8; ++corner) {
      const int i = cell[0] + (corner & 1), j = cell[1] + ((corner >> 1) & 1), l = cell[2] + ((corner >> 2) & 1);
      const int node = (l * (n + 1) + j) * (n + 1) + i;
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis) weight *= (corner >> axis) & 1 ? in_cell[axis] : 1.0 - in_cell[axis];
      u_m.col(k) += weight * (from_bullet(world_->body->m_nodes[node].m_x) - nth(world_->rest_m, node));
    }
  }
  return u_m;
}

double BulletPeer::dent_m() const noexcept {
  const int i = world_->top_middle;
  return nth(world_->rest_m, i).z() - from_bullet(world_->body->m_nodes[i].m_x).z();
}

double BulletPeer::pierced_m() const noexcept {
  const Vec3 center_m = from_bullet(world_->ball->getWorldTransform().getOrigin());
  double deepest_m = 0.0;
  for (int i = 0; i < world_->body->m_nodes.size(); ++i) {
    const double distance_m = (from_bullet(world_->body->m_nodes[i].m_x) - center_m).norm();
    deepest_m = std::max(deepest_m, world_->scene.ball_radius_m - distance_m);
  }
  return deepest_m;
}

int BulletPeer::contacts() const noexcept {
  return world_->body->m_nodeRigidContacts.size() + world_->body->m_faceRigidContacts.size();
}

}  // namespace touchstone::bench
