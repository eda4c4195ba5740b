// Files that are complete or absent, and folders for one process: under limits, kills and other processes.
#include "scene/base/files.h"

#include "scene/base/error.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

namespace touchstone::scene {
namespace {

using testing::HasSubstr;

class FilesTest : public testing::Test {
 protected:
  FilesTest() : root_(std::filesystem::temp_directory_path() / ("touchstone-files-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(root_);
  }
  ~FilesTest() override { std::filesystem::remove_all(root_); }

  static std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& entry : std::filesystem::directory_iterator(root_)) list.push_back(entry.path().filename());
    return list;
  }
  std::filesystem::path root_;
};

/// A process that holds a folder's lock until it is killed.
class Holder {
 public:
  explicit Holder(const std::filesystem::path& folder) {
    int ready[2];
    if (::pipe(ready) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      FolderLock lock(folder);
      const char taken = lock.try_take() ? 'y' : 'n';
      if (::write(ready[1], &taken, 1) != 1) ::_exit(1);
      for (;;) ::pause();
    }
    char taken = 'n';
    if (::read(ready[0], &taken, 1) != 1 || taken != 'y') throw std::runtime_error("the child has no lock");
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~Holder() { kill(); }
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_;
};

TEST_F(FilesTest, WritesAndReplacesAndLeavesNothingElse) {
  write_file(root_ / "file", "first");
  write_file(root_ / "file", std::string("a\0b", 3));
  EXPECT_EQ(content(root_ / "file"), std::string("a\0b", 3));
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(FilesTest, AFileThatGrowsHasItsNameWhenItIsComplete) {
  {
    UnfinishedFile file(root_ / "file");
    EXPECT_TRUE(file.append("first "));
    EXPECT_TRUE(file.append("second"));
    EXPECT_FALSE(std::filesystem::exists(root_ / "file"));
    EXPECT_TRUE(file.finish());
    EXPECT_EQ(content(root_ / "file"), "first second");
  }
  {
    UnfinishedFile file(root_ / "file");
    file.append("third");
  }
  EXPECT_EQ(content(root_ / "file"), "first second");
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(FilesTest, NothingIsWrittenThroughALink) {
  const std::filesystem::path victim = root_ / "victim";
  write_file(victim, "mine");
  for (const std::string& name : {std::string("file"), "file.touchstone-part-" + std::to_string(::getpid()) + "-0"}) {
    std::filesystem::create_symlink(victim, root_ / name);
  }
  write_file(root_ / "file", "new");
  EXPECT_EQ(content(victim), "mine");
  EXPECT_EQ(content(root_ / "file"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(root_ / "file"));
  std::filesystem::create_symlink(root_ / "made", root_ / "lock");
  EXPECT_THROW(FolderLock{root_}, std::filesystem::filesystem_error);
  EXPECT_FALSE(std::filesystem::exists(root_ / "made"));
}

TEST_F(FilesTest, RemovesNothingOfOthers) {
  const std::vector<std::string> files = {"holiday.part-1.zip",       "db.part-backup",         "a.touchstone-part-1",
                                          "a.touchstone-part-1-2.gz", ".touchstone-part-1-2",   "a.touchstone-part--",
                                          "a.touchstone-part-x-1",    "a.touchstone-part-1-2 ", "a.touchstone-part-1-"};
  for (const std::string& name : files) std::ofstream(root_ / name) << "x";
  std::filesystem::create_directory(root_ / "folder.touchstone-part-1-2");
  ASSERT_EQ(::mkfifo((root_ / "pipe.touchstone-part-1-2").c_str(), 0600), 0);
  std::filesystem::create_symlink(root_ / "db.part-backup", root_ / "link.touchstone-part-1-2");
  ::alarm(10);  // a pipe may be waited for
  remove_unfinished(root_);
  ::alarm(0);
  EXPECT_EQ(names().size(), files.size() + 3);
}

TEST_F(FilesTest, AFileThatDoesNotFitLeavesTheOldOneAndNothingElse) {
  write_file(root_ / "file", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_action = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::error_code why;
  try {
    write_file(root_ / "file", std::string(1001, 'x'));
  } catch (const std::filesystem::filesystem_error& error) {
    why = error.code();
    EXPECT_THAT(error.what(), HasSubstr((root_ / "file").string()));
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_action);
  EXPECT_EQ(why, std::errc::file_too_large);
  EXPECT_EQ(content(root_ / "file"), "old");
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(FilesTest, AWriterAndAJanitorMayMeet) {
  const pid_t janitor = ::fork();
  if (janitor == 0) {
    for (;;) remove_unfinished(root_);
  }
  // The clean-up may delete a file only between its creation and its locking.
  int given_up = 0;
  for (int i = 0; i < 200; ++i) {
    const std::string text = std::to_string(i) + std::string(3000, 'x');
    try {
      write_file(root_ / "file", text);
      EXPECT_EQ(content(root_ / "file"), text);
    } catch (const std::filesystem::filesystem_error& error) {
      EXPECT_EQ(error.code(), std::errc::no_such_file_or_directory);
      ++given_up;
    }
  }
  ::kill(janitor, SIGKILL);
  ::waitpid(janitor, nullptr, 0);
  EXPECT_LT(given_up, 10);
  remove_unfinished(root_);
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(FilesTest, OnlyWhatIsUnfinishedIsRemoved) {
  for (const char* name : {"file", "file.touchstone-part-12-0", "curve.csv.touchstone-part-99-3", "counter.part"}) {
    std::ofstream(root_ / name) << "x";
  }
  remove_unfinished(root_);
  EXPECT_THAT(names(), testing::UnorderedElementsAre("file", "counter.part"));
}

TEST_F(FilesTest, WhatALiveRunWritesStays) {
  const int file = ::open((root_ / "file.touchstone-part-12-0").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_EQ(::flock(file, LOCK_EX), 0);
  remove_unfinished(root_);
  EXPECT_THAT(names(), testing::ElementsAre("file.touchstone-part-12-0"));
  ::close(file);
  remove_unfinished(root_);
  EXPECT_TRUE(names().empty());
}

TEST_F(FilesTest, AFolderThatCannotBeIsRefusedInOneLine) {
  std::ofstream(root_ / "file") << "x";
  try {
    require_writable(root_ / "file" / "folder", "--store");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_THAT(text, testing::StartsWith("--store "));
    EXPECT_THAT(text, HasSubstr("Not a directory); expected a folder that can be written to"));
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
  require_writable(root_ / "a" / "b", "--out");
  EXPECT_TRUE(std::filesystem::is_empty(root_ / "a" / "b"));
}

TEST_F(FilesTest, AFolderOnAFullDiskIsRefused) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_action = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
  EXPECT_THROW(require_writable(root_, "--out"), InputError);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_action);
  EXPECT_TRUE(names().empty());
}

TEST_F(FilesTest, ALockIsOfOneProcessAndDiesWithIt) {
  EXPECT_FALSE(FolderLock::held(root_));
  Holder holder(root_);
  FolderLock lock(root_);
  EXPECT_TRUE(FolderLock::held(root_));
  EXPECT_FALSE(lock.try_take());
  int waited = 0;
  lock.take([&] {
    if (++waited == 2) holder.kill();
  });
  EXPECT_EQ(waited, 2);
  EXPECT_TRUE(FolderLock::held(root_));
  struct GivenUp {};
  EXPECT_THROW(FolderLock(root_).take([] { throw GivenUp(); }), GivenUp);
}

}  // namespace
}  // namespace touchstone::scene
