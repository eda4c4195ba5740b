// The fast model's result depends on the keys for which the table says so, and on no others.
#include "fast/run/run.h"

#include "support/key_changes.h"

#include <gtest/gtest.h>

#include <map>

namespace touchstone::fast {
namespace {

TEST(Keys, ChangeTheAnswerOnlyWhereTheTableSaysThatFastReadsThem) {
  std::map<const scene::Scene*, std::uint64_t> before;
  for (const test::KeyChange& change : test::every_key_changed()) {
    const auto [at, first] = before.try_emplace(change.before.get());
    if (first) at->second = run(*change.before).state_hash;
    const bool changes = run(change.after).state_hash != at->second;
    EXPECT_TRUE(!changes || scene::fast_reads(change.side)) << change.key;
    if (!changes && scene::fast_reads(change.side)) std::cout << "same " << change.key << "\n";
  }
}

}  // namespace
}  // namespace touchstone::fast
