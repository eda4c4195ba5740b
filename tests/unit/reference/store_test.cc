#include "reference/store.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace touchstone::reference {
namespace {

class StoreTest : public testing::Test {
 protected:
  StoreTest() : root_(std::filesystem::temp_directory_path() / ("touchstone-store-" + std::to_string(::getpid()))) {}
  ~StoreTest() override { std::filesystem::remove_all(root_); }
  static void never() { FAIL() << "the lock should be free"; }
  std::filesystem::path root_;
};

Record sample() {
  Record record;
  record.put(0.1);
  record.put(7);
  record.put(std::string_view("text"));
  return record;
}

TEST_F(StoreTest, GivesBackWhatWasWritten) {
  Store store(root_, "a scene", never);
  EXPECT_FALSE(store.read(0, 3));
  store.write(0, 3, sample());
  auto record = store.read(0, 3);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->take_double(), 0.1);
  EXPECT_EQ(record->take_int(), 7);
  EXPECT_EQ(record->take_text(), "text");
  EXPECT_TRUE(record->at_end());
  EXPECT_THROW((void)record->take_int(), std::out_of_range);
}

TEST_F(StoreTest, TornOrAlteredFileIsNotRead) {
  Store store(root_, "a scene", never);
  for (const bool torn : {true, false}) {
    store.write(1, 1, sample());
    const auto file = store.step_file(1, 1);
    if (torn) {
      std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
    } else {
      std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
      stream.seekp(-2, std::ios::end);
      stream.put('X');
    }
    EXPECT_FALSE(store.read(1, 1));
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}

TEST_F(StoreTest, SecondHolderWaits) {
  struct Gave {};
  const Store first(root_, "a scene", never);
  const Store other(root_, "another scene", never);
  EXPECT_THROW(Store(root_, "a scene", [] { throw Gave(); }), Gave);
}

}  // namespace
}  // namespace touchstone::reference
