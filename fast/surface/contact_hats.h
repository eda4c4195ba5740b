// The kernel functions (hats) of several contact points and the coefficients that make a quantity interpolate at them,
// section VI-B.
#pragma once

#include "fast/surface/hat.h"
#include "fast/surface/interpolation.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace touchstone::fast {

/// Contact points p0_k in order of creation, each with its hat h_k. A quantity that is W(p) on its own gets the value
/// target_j at p0_j, for all j <= i, by the coefficients c_k of sum_k h_k(p0_j) c_k = target_j - W(p0_j): one
/// triangular factorisation that grows by a row and a column per contact point, since the matrix of i is a corner of
/// the next one's. Its pivots are bounded away from zero: where a contact point is within a hundredth of its patch of
/// an earlier one, its own value is not met in full, and the coefficients stay bounded. A contact point that does not
/// move the surface (held, or without force) takes no part. Storage is fixed at construction.
class ContactHats {
 public:
  ContactHats(std::size_t patches, std::size_t capacity);
  void clear() noexcept { count_ = 0; }
  /// Takes the next contact point in; at most `capacity` between clears. @param part_of the hat's kind
  void add(const SurfacePatches& rest, const ContactPoint& contact, decltype(hat_part)* part_of) noexcept;

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return top_.size(); }
  [[nodiscard]] bool takes_part(std::size_t k) const noexcept { return top_[k].takes_part; }
  /// What h_k is on a patch.
  [[nodiscard]] const HatPart& part(std::size_t k, std::size_t patch) const noexcept {
    return part_[k * patches_ + patch];
  }
  /// Turns right-hand sides, one per contact point, into coefficients, in place. @tparam Value number or vector
  template <class Value>
  void solve(Value* x) const noexcept {
    const std::size_t n = capacity();
    for (std::size_t j = 1; j < count_; ++j) {
      for (std::size_t m = 0; m < j; ++m) x[j] -= factor_[j * n + m] * x[m];
    }
    for (std::size_t j = count_; j-- > 0;) {
      for (std::size_t m = j + 1; m < count_; ++m) x[j] -= factor_[j * n + m] * x[m];
      x[j] /= factor_[j * n + j];
    }
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct Top {
    std::size_t patch = 0;
    PatchPlace place;
    bool takes_part = false;
  };
  /// h_k(p0_j)
  [[nodiscard]] double at_contact(std::size_t k, std::size_t j) const noexcept {
    return top_[j].takes_part ? part(k, top_[j].patch).at(top_[j].place) : 0.0;
  }

  std::size_t count_ = 0, patches_;
  std::vector<Top> top_;
  std::vector<HatPart> part_;   ///< rows of one per patch
  std::vector<double> factor_;  ///< L below and U above the diagonal, rows of `capacity`
};

}  // namespace touchstone::fast
