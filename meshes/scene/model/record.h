// What a solver answers: the contract between fast/, reference/ and compare/. Plain data, SI units,
// world frame. Forces act on the tool unless named as the support's.
#pragma once

#include "scene/base/frames.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace touchstone::scene {

/// One contact region at one instant.
struct RegionRecord {
  double depth_m = 0.0;            ///< rest_depth_m of the region
  Vec3 force_n = Vec3::Zero();     ///< on the tool
  Vec3 torque_nm = Vec3::Zero();   ///< on the tool, about its mass centre
  double area_m2 = 0.0;            ///< contact area
  int id = 0;                      ///< the smallest number free at its creation, kept while it lives
  Vec3 friction_n = Vec3::Zero();  ///< part of force_n along the surface, where the scene has friction
  bool sliding = false;            ///< slips over the surface, where the scene has friction
};

/// One side's answer at one track instant.
struct InstantRecord {
  double time_s = 0.0;
  Pose tool;
  double depth_m = 0.0;                 ///< rest_depth_m, zero when apart
  double separation_m = 0.0;            ///< between tool and body while apart; 0 from a solver that does not compute it
  std::vector<RegionRecord> regions;    ///< empty when apart; in the order of their creation
  Vec3 support_force_n = Vec3::Zero();  ///< of the support on the body
  Eigen::Matrix3Xd displacement_m;      ///< one column per rest point asked for

  /// Sum over the regions [N].
  [[nodiscard]] Vec3 force_n() const {
    Vec3 sum = Vec3::Zero();
    for (const RegionRecord& region : regions) sum += region.force_n;
    return sum;
  }
};

/// Figures by stable dotted key (design: Results), in the order they were measured.
/// Numbers and strings are kept apart only when written; `unit` is "" for a ratio or a text.
struct Figure {
  std::string key;
  double number = 0.0;
  std::string text;  ///< not empty: the figure is this text; beside a number that is NaN: why there is none
  std::string unit;
};
using Figures = std::vector<Figure>;

/// The figure of this key, or null.
[[nodiscard]] const Figure* find_figure(const Figures& figures, std::string_view key);

}  // namespace touchstone::scene
