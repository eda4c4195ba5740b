// Points of a region with storage of their own, for tests of single stages.
#pragma once

#include "fast/contact/contact_detection.h"

namespace touchstone::test {

struct OwnedPoints : fast::RegionPoints {
  explicit OwnedPoints(int places) : store(places) { RegionPoints::operator=(store.window()); }
  OwnedPoints(OwnedPoints&&) = default;
  fast::PointStore store;
};

}  // namespace touchstone::test
