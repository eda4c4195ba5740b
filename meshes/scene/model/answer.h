// What a model answers: the contract between fast/, reference/ and compare/. Plain data, SI units,
// world frame. Forces act on the tool unless the name says support.
#pragma once

#include "scene/base/frames.h"
#include "scene/shape/surface.h"

#include <cstddef>
#include <iterator>
#include <vector>

namespace touchstone::scene {

/// One contact region at one instant.
struct RegionRecord {
  double depth_m = 0.0;            ///< rest_depth_m of the region
  Vec3 force_n = Vec3::Zero();     ///< on the tool
  Vec3 torque_nm = Vec3::Zero();   ///< on the tool, about its mass centre
  double area_m2 = 0.0;            ///< contact area
  int id = 0;                      ///< the smallest free number when the region begins, kept until it ends
  Vec3 friction_n = Vec3::Zero();  ///< part of force_n along the surface, where the scene has friction
  bool sliding = false;            ///< slips over the surface, where the scene has friction
};

/// One side's answer at one track instant.
struct InstantRecord {
  double time_s = 0.0;
  Pose tool;
  double depth_m = 0.0;                 ///< rest_depth_m, zero when apart
  double separation_m = 0.0;            ///< between tool and body while apart; 0 if the solver does not compute it
  std::vector<RegionRecord> regions;    ///< empty when apart; in the order of their creation
  Vec3 support_force_n = Vec3::Zero();  ///< of the support on the body
  Eigen::Matrix3Xd displacement_m;      ///< one column per rest point asked for
  Eigen::Matrix3Xd normal;              ///< of the moved surface, unit, per rest point; empty where not computed
  Eigen::Matrix3Xd traction_pa;         ///< of the tool on the body, per rest point and current area; empty where not
                                        ///< computed
  double pressure_peak_pa = 0.0;        ///< largest contact pressure, per current area; 0 where not computed

  // Sums over the regions.
  [[nodiscard]] Vec3 force_n() const { return sum(&RegionRecord::force_n); }
  [[nodiscard]] Vec3 torque_nm() const { return sum(&RegionRecord::torque_nm); }
  [[nodiscard]] Vec3 friction_n() const { return sum(&RegionRecord::friction_n); }

 private:
  [[nodiscard]] Vec3 sum(Vec3 RegionRecord::*of) const {
    Vec3 sum = Vec3::Zero();
    for (const RegionRecord& region : regions) sum += region.*of;
    return sum;
  }
};

/// What any model says of a whole track.
struct Answer {
  Surface surface;                      ///< at rest; its points are the rest points of the records
  std::vector<InstantRecord> instants;  ///< at instants_s
};

/// What the reference says of one instant: its answer, how far that may be off, and how well the contact is resolved.
struct ReferenceInstant : InstantRecord {
  std::vector<Vec3> region_middles_m;          ///< one for every region that pushes
  double force_uncertainty_n = 0.0;            ///< conservative half width; NaN where unknown
  Eigen::VectorXd displacement_uncertainty_m;  ///< the same per rest point
  Eigen::VectorXd traction_uncertainty_pa;     ///< the same
  double pressure_peak_uncertainty_pa = 0.0;   ///< conservative half width; NaN where unknown
  /// Long and short, of the region that pushes most: those of the ellipse that has its area's second moments, seen
  /// along the normal force. A round contact has its radius twice.
  Eigen::Vector2d contact_half_axes_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d contact_half_axes_uncertainty_m = Eigen::Vector2d::Zero();  ///< half widths; NaN where unknown
  double residual_penetration_m = 0.0;                                        ///< largest over contact nodes
  double between_nodes_penetration_m = 0.0;                                   ///< largest over face quadrature points
  double equilibrium_rel = 0.0;                                               ///< |contact + support| / |contact|
  double volume_change_rel = 0.0;                                             ///< of the body
};

/// The records of an answer in order, whatever else an answer holds beside each. Refers to the list it is made from.
class Instants {
 public:
  template <class Record>
  Instants(const std::vector<Record>& records) {  // NOLINT(google-explicit-constructor): it represents the list
    records_.reserve(records.size());
    for (const InstantRecord& record : records) records_.push_back(&record);
  }
  [[nodiscard]] std::size_t size() const noexcept { return records_.size(); }
  [[nodiscard]] const InstantRecord& operator[](std::size_t i) const noexcept { return *records_[i]; }

  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = InstantRecord;
    using difference_type = std::ptrdiff_t;
    using pointer = const InstantRecord*;
    using reference = const InstantRecord&;
    Iterator() = default;
    explicit Iterator(const InstantRecord* const* at) : at_(at) {}
    reference operator*() const noexcept { return **at_; }
    pointer operator->() const noexcept { return *at_; }
    Iterator& operator++() noexcept { return ++at_, *this; }
    Iterator operator++(int) noexcept { return Iterator(at_++); }
    bool operator==(const Iterator&) const = default;

   private:
    const InstantRecord* const* at_ = nullptr;
  };
  [[nodiscard]] Iterator begin() const noexcept { return Iterator(records_.data()); }
  [[nodiscard]] Iterator end() const noexcept { return Iterator(records_.data() + records_.size()); }

 private:
  std::vector<const InstantRecord*> records_;
};

}  // namespace touchstone::scene
