// Finds what of the tool's surface is inside the body, cell by cell: cells that the rest surface cuts give what is
// below it, and where few are inside they are halved.
#pragma once

#include "fast/contact/cell_batch.h"
#include "fast/contact/region_points.h"
#include "fast/contact/rest_distance.h"
#include "fast/contact/tool_samples.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchstone::fast {

/// How the tool's cells become points.
struct CellRule {
  /// Fewer cells than these inside are too few. A device leaves the track, so a scene has no fewer than the default,
  /// see SlidingOverAnEdgeTurnsTheForceGradually.
  int points = 48;
  int halvings = 0;  ///< of all of them beyond that
  int room = 1024;   ///< halved cells that find_cells() makes in a tick, at most
};

/// A cell at its place.
struct PlacedCell {
  const SurfaceCell* cell;
  scene::Vec3 p_W;             ///< its centre
  RestDistance rest;           ///< of that
  scene::Vec3 normal_T;        ///< of that, tool frame
  double lowest_m, highest_m;  ///< signed distance of its corners from the tangent plane of the rest surface

  [[nodiscard]] bool wholly_inside() const noexcept { return rest.signed_distance_m <= -cell->radius_m; }
};

/// Halves of a tool's cells, and theirs. They are kept, since a contact mostly asks for those of the last tick; the
/// answer never depends on which are.
class CellHalves {
 public:
  /// Of no cell: for samples in place of cells.
  CellHalves() = default;
  /// Takes storage for the halves of two ticks, and for 4096 at least.
  /// @param samples  number of the tool's samples; @param room  of CellRule
  CellHalves(int samples, int room);
  /// Makes room for a tick's halves.
  void begin() noexcept;
  /// Puts the halves of its cells into `cells`. @param of_tool  those are samples' cells, not halves
  void halve(const ToolSamples& tool, bool of_tool, std::vector<std::int32_t>& cells) noexcept;
  [[nodiscard]] const SurfaceCell& half(std::int32_t index) const noexcept {
    return halves_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] std::size_t samples() const noexcept { return of_sample_.size(); }
  [[nodiscard]] std::size_t room() const noexcept { return room_; }
  /// How many are kept.
  [[nodiscard]] std::size_t kept() const noexcept { return used_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  /// The first of the two halves of a sample's cell, or of a half; the second follows it.
  [[nodiscard]] std::int32_t halves_of_sample(const ToolSamples& tool, std::int32_t sample) noexcept;
  [[nodiscard]] std::int32_t halves_of_half(const ToolSamples& tool, std::int32_t half) noexcept;
  [[nodiscard]] std::int32_t halves_of(const ToolSamples& tool, const SurfaceCell& cell, std::int32_t& first) noexcept;
  std::size_t room_ = 0;
  std::vector<SurfaceCell> halves_;
  std::vector<std::int32_t> of_half_, of_sample_;  ///< the first half of each, -1 for not known
  std::size_t used_ = 0;
};

/// What find_cells() writes on its way.
struct CellScratch {
  explicit CellScratch(CellHalves begin_with = {});
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  CellHalves halves;
  std::vector<std::int32_t> now, near;  ///< cells of a round, and those of them that are near the body
  std::vector<PlacedCell> placed;       ///< those and what else is looked for
  CellBatch batch;
};

/// Fills `points` with what lies inside the rest surface of the tool's cells, one point for each at the middle of that
/// part and with its area. Where too few cells are inside, all that are near the body are halved, and again, as far as
/// there is room.
/// @param margin_m what lies outside, but for less than that, are points too, of negative depth
using FindCells = InsideSummary (*)(const scene::Shape&, const ToolSamples&, const Placement&, const CellRule&,
                                    double margin_m, RegionPoints&, CellScratch&) noexcept;
[[nodiscard]] FindCells find_cells_for(const scene::Shape&) noexcept;

}  // namespace touchstone::fast
