#include "scene/base/index.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace touchstone {
namespace {

enum class Colour : std::int8_t { red, green };

TEST(Index, OfAnyTypeNamesTheElementItself) {
  std::vector<int> v{3, 4, 5};
  const std::array<double, 2> a{0.5, 0.25};
  nth(v, std::int32_t{2}) = 7;
  ++nth(v, 0);
  EXPECT_EQ(v, (std::vector<int>{4, 4, 7}));
  EXPECT_EQ(&nth(v, 1L), &v[1]);
  EXPECT_EQ(nth(a, Colour::green), 0.25);
  EXPECT_EQ(nth(v.data(), 2u), 7);
  static_assert(std::is_same_v<decltype(nth(a, 0)), const double&>&& noexcept(nth(v, 0)));
}

}  // namespace
}  // namespace touchstone
