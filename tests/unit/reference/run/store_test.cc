#include "reference/run/store.h"

#include "scene/base/error.h"
#include "scene/base/hash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <string>

namespace touchstone::reference {
namespace {

class StoreTest : public testing::Test {
 protected:
  StoreTest() : root_(std::filesystem::temp_directory_path() / ("touchstone-store-" + std::to_string(::getpid()))) {}
  ~StoreTest() override { std::filesystem::remove_all(root_); }
  static void never() { FAIL() << "the lock should be free"; }
  std::filesystem::path root_;
};

const std::string sample("a record \0 with any bytes", 25);

TEST_F(StoreTest, GivesBackWhatWasWritten) {
  Store store(root_, "a scene", never);
  EXPECT_FALSE(store.read(0, 3));
  store.write(0, 3, sample);
  EXPECT_EQ(store.read(0, 3), sample);
}

TEST_F(StoreTest, TornOrAlteredFileIsNotRead) {
  Store store(root_, "a scene", never);
  for (const bool torn : {true, false}) {
    store.write(1, 1, sample);
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

TEST_F(StoreTest, AnAlteredIdentityIsToldAndWrittenAgain) {
  { const Store store(root_, "a scene", never); }
  const std::filesystem::path file = root_ / Store::key("a scene") / "identity.txt";
  scene::write_file(file, "another scene");
  testing::internal::CaptureStderr();
  { const Store store(root_, "a scene", never); }
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("is not the text that the folder is named by"));
  EXPECT_EQ(scene::read_file(file), "a scene");
  testing::internal::CaptureStderr();
  { const Store store(root_, "a scene", never); }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(StoreTest, AnotherStepsFileIsNotRead) {
  Store store(root_, "a scene", never);
  Store other(root_, "another scene", never);
  store.write(0, 0, sample);
  const auto copy = [&](const std::filesystem::path& to) {
    std::filesystem::create_directories(to.parent_path());
    std::filesystem::copy_file(store.step_file(0, 0), to);
  };
  copy(store.step_file(0, 1));
  copy(store.step_file(1, 0));
  copy(other.step_file(0, 0));
  EXPECT_FALSE(store.read(0, 1));
  EXPECT_FALSE(store.read(1, 0));
  EXPECT_FALSE(other.read(0, 0));
  EXPECT_TRUE(store.read(0, 0));
}

TEST_F(StoreTest, AFileOfTheFormerFormatIsNotRead) {
  Store store(root_, "a scene", never);
  std::filesystem::create_directories(store.step_file(0, 0).parent_path());
  std::ofstream(store.step_file(0, 0), std::ios::binary) << "touchstone reference step\n"
                                                         << scene::hash_text(sample) << '\n'
                                                         << sample;
  EXPECT_FALSE(store.read(0, 0));
  EXPECT_NE(Store::key("a scene"), scene::hash_text("a scene"));
}

TEST_F(StoreTest, WhatKilledRunsLeftIsRemoved) {
  const auto step = [&] { return Store(root_, "a scene", never).step_file(0, 0); }();
  std::filesystem::create_directories(step.parent_path());
  const std::filesystem::path leftovers[] = {step.string() + ".touchstone-part-123-0",
                                             step.parent_path().parent_path() / "identity.txt.touchstone-part-9-0"};
  for (const auto& leftover : leftovers) std::ofstream(leftover) << "half";
  const Store store(root_, "a scene", never);
  for (const auto& leftover : leftovers) EXPECT_FALSE(std::filesystem::exists(leftover)) << leftover;
}

TEST_F(StoreTest, AFolderThatCannotBeIsRefused) {
  std::ofstream(root_) << "a file";
  EXPECT_THROW(Store(root_, "a scene", never), scene::InputError);
}

TEST_F(StoreTest, SecondHolderWaits) {
  struct Gave {};
  const Store first(root_, "a scene", never);
  const Store other(root_, "another scene", never);
  EXPECT_THROW(Store(root_, "a scene", [] { throw Gave(); }), Gave);
}

}  // namespace
}  // namespace touchstone::reference
