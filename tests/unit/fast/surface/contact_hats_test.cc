#include "fast/surface/contact_hats.h"

#include "unit/fast/surface/region_rig.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;
using test::Rig;

ContactPoint contact_at(const Rig& s, const Vec3& p_m, const Vec3& displacement_m = Vec3(0.0, 0.0, -1e-3)) {
  const scene::SurfaceQuery at = s.model.body->query(p_m);
  return {displacement_m, at.normal, at.patch, s.model.anchors->at(at.patch, at.point_m)};
}

/// Sum of the kernel functions times their coefficients at a contact point.
template <class Value>
Value sum_at(const ContactHats& hats, const std::vector<Value>& c, const ContactPoint& at) {
  Value sum = c[0] - c[0];
  for (std::size_t k = 0; k < hats.count(); ++k)
    sum += hats.part(k, static_cast<std::size_t>(at.patch)).at(at.place) * c[k];
  return sum;
}

TEST(ContactHats, CoefficientsMeetTheTargetAtEveryContactPoint) {
  const Rig s(test::ball_on_cube());
  ContactHats hats(s.model.rest.patches.size(), 4);
  std::vector<ContactPoint> contacts;
  for (const Vec3& p_m : {Vec3(0.0061, 0.0043, 0.06), Vec3(-0.0077, 0.0029, 0.06), Vec3(0.029, 0.0131, 0.051),
                          Vec3(0.0132, -0.0111, 0.06)}) {
    contacts.push_back(contact_at(s, p_m));
    hats.add(s.model.rest, contacts.back(), hat_part);
    const std::size_t count = hats.count();
    ASSERT_EQ(count, contacts.size());
    std::vector<double> numbers{1.0, -2.0, 0.5, 3.0};
    std::vector<Vec3> vectors{Vec3(1, 2, 3), Vec3(-1, 0, 2), Vec3(0, 0, 1), Vec3(2, -2, 0)};
    const std::vector<double> targets = numbers;
    const std::vector<Vec3> vector_targets = vectors;
    hats.solve(numbers.data());
    hats.solve(vectors.data());
    for (std::size_t j = 0; j < count; ++j) {
      EXPECT_NEAR(sum_at(hats, numbers, contacts[j]), targets[j], 1e-13) << count << ' ' << j;
      EXPECT_LT((sum_at(hats, vectors, contacts[j]) - vector_targets[j]).norm(), 1e-13) << count << ' ' << j;
    }
  }
}

TEST(ContactHats, HeldAndForcelessContactsTakeNoPart) {
  const Rig s(test::ball_on_cube());
  ContactHats hats(s.model.rest.patches.size(), 3);
  hats.add(s.model.rest, contact_at(s, Vec3(0.004, 0.003, 0.06)), hat_part);
  hats.add(s.model.rest, contact_at(s, Vec3(0.006, 0.003, 0.06), Vec3::Zero()), hat_part);
  hats.add(s.model.rest, contact_at(s, Vec3(0.004, 0.003, -0.01)), hat_part);
  EXPECT_TRUE(hats.takes_part(0));
  EXPECT_FALSE(hats.takes_part(1));
  EXPECT_FALSE(hats.takes_part(2));
  std::array<double, 3> c{2.0, 0.0, 0.0};
  hats.solve(c.data());
  EXPECT_EQ(c, (std::array<double, 3>{2.0, 0.0, 0.0}));
}

TEST(ContactHats, CoefficientsStayBoundedAtOnePlace) {
  const Rig s(test::ball_on_cube());
  ContactHats hats(s.model.rest.patches.size(), 2);
  for (int k = 0; k < 2; ++k) hats.add(s.model.rest, contact_at(s, Vec3(0.004, 0.002, 0.06)), hat_part);
  std::array<double, 2> c{0.0, 1.0};
  hats.solve(c.data());
  for (const double x : c) EXPECT_LE(std::abs(x), 32.0);
  hats.clear();
  EXPECT_EQ(hats.count(), 0u);
}

}  // namespace
}  // namespace touchstone::fast
