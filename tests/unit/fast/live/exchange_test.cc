// Data exchange between threads. Run under ThreadSanitizer by hand when these headers change:
// g++ -std=c++20 -O1 -g -fsanitize=thread -I. tests/unit/fast/live/exchange_test.cc -lgtest -lgtest_main
// -o /tmp/exchange
#include "fast/live/record_ring.h"
#include "fast/live/triple_buffer.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

namespace touchstone::live {
namespace {

/// A value that shows a torn read.
struct Block {
  std::array<std::uint64_t, 64> copies{};
  void fill(std::uint64_t n) { copies.fill(n); }
  [[nodiscard]] bool whole() const {
    for (const std::uint64_t n : copies) {
      if (n != copies[0]) return false;
    }
    return true;
  }
};

TEST(TripleBuffer, GivesTheNewestOnce) {
  TripleBuffer<int> buffer(-1);
  EXPECT_FALSE(buffer.take());
  EXPECT_EQ(buffer.front(), -1);
  buffer.back() = 1;
  EXPECT_FALSE(buffer.take()) << "not published";
  buffer.publish();
  EXPECT_TRUE(buffer.take());
  EXPECT_EQ(buffer.front(), 1);
  EXPECT_FALSE(buffer.take());
  EXPECT_EQ(buffer.front(), 1);
  for (int i = 2; i < 10; ++i) {
    buffer.back() = i;
    buffer.publish();
  }
  EXPECT_TRUE(buffer.take());
  EXPECT_EQ(buffer.front(), 9);
  EXPECT_FALSE(buffer.take());
}

TEST(TripleBuffer, TheWriterNeverTouchesWhatTheReaderHolds) {
  TripleBuffer<int> buffer(0);
  buffer.back() = 1;
  buffer.publish();
  ASSERT_TRUE(buffer.take());
  const int* held = &buffer.front();
  for (int i = 2; i < 20; ++i) {
    EXPECT_NE(&buffer.back(), held);
    buffer.back() = i;
    buffer.publish();
    EXPECT_EQ(*held, 1);
  }
}

TEST(TripleBuffer, BetweenTwoThreadsNothingIsTornAndTimeGoesForward) {
  TripleBuffer<Block> buffer(Block{});
  constexpr std::uint64_t last = 200000;
  std::jthread writer([&] {
    for (std::uint64_t n = 1; n <= last; ++n) {
      buffer.back().fill(n);
      buffer.publish();
    }
  });
  std::uint64_t before = 0;
  while (before < last) {
    if (!buffer.take()) continue;
    ASSERT_TRUE(buffer.front().whole());
    ASSERT_GT(buffer.front().copies[0], before);
    before = buffer.front().copies[0];
  }
  EXPECT_FALSE(buffer.take());
}

TEST(RecordRing, KeepsOrderAndCountsWhatItDrops) {
  RecordRing<int> ring(5);
  EXPECT_EQ(ring.capacity(), 8u);
  for (int i = 0; i < 11; ++i) EXPECT_EQ(ring.push(i), i < 8);
  EXPECT_EQ(ring.dropped(), 3u);
  int record = -1;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(record));
    EXPECT_EQ(record, i);
  }
  EXPECT_FALSE(ring.pop(record));
  EXPECT_TRUE(ring.push(11)) << "room again";
  EXPECT_TRUE(ring.pop(record));
  EXPECT_EQ(record, 11);
  EXPECT_EQ(ring.dropped(), 3u);
}

TEST(RecordRing, BetweenTwoThreadsEveryRecordIsReadOrCounted) {
  RecordRing<Block> ring(64);
  constexpr std::uint64_t total = 100000;
  std::atomic<bool> done{false};
  std::jthread producer([&] {
    Block block;
    for (std::uint64_t n = 1; n <= total; ++n) {
      block.fill(n);
      ring.push(block);
      if (n % 1000 == 0) std::this_thread::yield();
    }
    done.store(true);
  });
  std::uint64_t read = 0, before = 0;
  while (true) {
    const bool last_round = done.load();
    Block block;
    while (ring.pop(block)) {
      ASSERT_TRUE(block.whole());
      ASSERT_GT(block.copies[0], before);
      before = block.copies[0];
      ++read;
    }
    if (last_round) break;
  }
  EXPECT_EQ(read + ring.dropped(), total);
  EXPECT_GT(read, 0u);
}

}  // namespace
}  // namespace touchstone::live
