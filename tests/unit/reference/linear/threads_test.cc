// Threads for a solve: not more than there are idle processors.
#include "reference/linear/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace touchstone::reference {
namespace {

TEST(Threads, RunnableOnesAreReadFromTheLoad) {
  EXPECT_EQ(runnable_threads("0.00 0.01 0.05 1/123 4567\n"), 1);
  EXPECT_EQ(runnable_threads("17.20 3.00 1.00 42/1123 4567"), 42);
  EXPECT_EQ(runnable_threads("0.00 0.01"), 0);
  EXPECT_EQ(runnable_threads(""), 0);
}

TEST(Threads, BusyProcessorsAreLeftAlone) {
  const unsigned processors = std::thread::hardware_concurrency();
  EXPECT_LE(idle_processors(), static_cast<int>(processors));
  std::atomic<bool> over = false;
  std::vector<std::jthread> busy;
  for (unsigned i = 0; i < processors; ++i) {
    busy.emplace_back([&over] {
      while (!over) {
      }
    });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(idle_processors(), 1);
  over = true;
}

}  // namespace
}  // namespace touchstone::reference
