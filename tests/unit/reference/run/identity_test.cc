// What enters the key of a stored answer is what the table of keys says that the reference reads.
#include "reference/run/identity.h"

#include "support/key_changes.h"

#include <gtest/gtest.h>

#include <set>

namespace touchstone::reference {
namespace {

TEST(Identity, ChangesWithWhatTheTableSaysThatTheReferenceReadsAndNothingElse) {
  std::set<std::string> changed;
  for (const test::KeyChange& change : test::every_key_changed()) {
    changed.insert(change.key);
    EXPECT_EQ(identity_text(*change.before) != identity_text(change.after), scene::reference_reads(change.side))
        << change.key;
  }
  // Its one value is no choice yet.
  changed.insert("body.support");
  std::set<std::string> all;
  for (const auto& field : scene::scene_fields()) all.emplace(field.key);
  for (const auto& field : scene::inclusion_fields()) all.insert("body.inclusion[]." + std::string(field.key));
  for (const auto& field : scene::probe_fields()) all.insert("probe[]." + std::string(field.key));
  for (const auto& field : scene::track_fields()) all.insert("track[]." + std::string(field.key));
  EXPECT_EQ(changed, all);
}

}  // namespace
}  // namespace touchstone::reference
