// The constant data of the real-time step, built once from a scene.
#pragma once

#include "fast/contact/contact_detection.h"
#include "fast/contact/contact_law.h"
#include "fast/contact/contact_regions.h"
#include "fast/contact/find_cells.h"
#include "fast/contact/friction.h"
#include "fast/contact/mass_distribution.h"
#include "fast/contact/tool_samples.h"
#include "fast/skeleton/anchor_points.h"
#include "fast/skeleton/beam_skeleton.h"
#include "fast/surface/interpolation.h"
#include "fast/surface/local_factor.h"
#include "fast/surface/normals.h"
#include "fast/surface/region_shapes.h"
#include "fast/surface/surface_patches.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace touchstone::fast {

/// Cells of a scene's contact.
struct ContactCells {
  CellRule rule;
  CellHalves halves;  ///< those that the track asks for, made at set-up; empty, or of another room: not made
  /// How far the load is from its limit of ever smaller cells, at most over the track, relative to that limit or, where
  /// that is less, a fifth of the track's largest; 0 where that is not known.
  double error_rel = 0.0;
};

/// The stages in which the published and the corrected formulation differ, chosen when the model is built.
struct Formulas {
  DistributeMass distribute_mass = nullptr;
  ResolveFriction resolve_friction = nullptr;  ///< null where the scene has no friction: there is no such stage
  SplitForce split_force = nullptr;
  Interpolate interpolate = nullptr;
  ApplyLocalFactor apply_local_factor = nullptr;  ///< null where C_n = 0: there is no such stage
  SeveralRegions several;                         ///< only asked where the model has several regions
  [[nodiscard]] bool local_factor() const noexcept { return apply_local_factor != nullptr; }
};

/// The constant part of the fast model.
struct FastModel {
  /// Allocates and precomputes; throws std::bad_alloc only.
  /// @param scene validated
  explicit FastModel(const scene::Scene& scene);

  /// Takes over the constants of the laws, the skeleton and the local factor from a scene that differs in nothing else.
  void set_constants(const scene::Scene& scene);

  std::unique_ptr<const scene::Shape> body;  ///< rest shape
  Detection detection;
  ToolSamples tool;
  /// Parts of the tool's surface that become contact points, see model_of(); without them its samples do.
  std::optional<ContactCells> cells;
  ContactLaw law;
  std::optional<FrictionLaw> friction;
  std::unique_ptr<const AnchorPoints> anchors;
  BeamSkeleton skeleton;
  LocalConstants local;
  scene::Surface surface;  ///< rest points and triangles in full precision
  SurfacePatches rest;
  NormalStencils normals;
  Formulas formulas;
  std::unique_ptr<const ClusterGrid> clusters;  ///< null where the model has one region
  int max_regions = 1;                          ///< capacity; 1 for a convex tool

  /// Points of a tick, at most: two for each cell, its part inside and, for several regions, the one outside.
  [[nodiscard]] int max_points() const noexcept {
    return cells ? 2 * std::max(tool.count(), cells->rule.room / 2) : tool.count();
  }
  /// For find_points().
  [[nodiscard]] CellScratch cell_scratch() const {
    if (!cells) return CellScratch();
    const bool made = cells->halves.room() == static_cast<std::size_t>(cells->rule.room);
    return CellScratch(made ? cells->halves : CellHalves(tool.count(), cells->rule.room));
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

}  // namespace touchstone::fast
