// Indices of any integer type or enumeration.
#pragma once

#include "scene/base/inline.h"

#include <cstddef>

namespace touchstone {

/// v[i] without a cast in the formula. @param v vector, array, span or pointer; @param i not negative
template <class Sequence, class Index>
[[nodiscard]] TOUCHSTONE_INLINE constexpr decltype(auto) nth(Sequence&& v, Index i) noexcept {
  return v[static_cast<std::size_t>(i)];  // NOLINT(bugprone-signed-char-misuse): i is not negative
}

}  // namespace touchstone
