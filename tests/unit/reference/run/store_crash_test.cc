// The store under kill -9 at any instant, full disks and rivals. Every solve runs in a process of its own; what it
// answers comes back as a file of bits.
#include "reference/linear/record.h"
#include "reference/run/store.h"
#include "reference/solver.h"
#include "scene/base/files.h"
#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <sstream>
#include <thread>

namespace touchstone::reference {
namespace {

using testing::HasSubstr;

void never() { FAIL() << "the lock should be free"; }

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

int unfinished_files(const std::filesystem::path& root) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    count += entry.path().filename().string().find(".touchstone-part-") != std::string::npos ? 1 : 0;
  }
  return count;
}

/// A process of its own running `work`, whose result is its exit status.
class Child {
 public:
  explicit Child(const std::function<int()>& work) : process_(::fork()) {
    if (process_ == 0) {
      int status = 99;
      try {
        status = work();
      } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
      }
      ::_exit(status);
    }
  }
  ~Child() {
    if (!ended_) kill();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// @returns whether it was still running
  bool kill() {
    ::kill(process_, SIGKILL);
    return wait() == -SIGKILL;
  }
  /// @returns its exit status, or the negative number of the signal that ended it
  int wait() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t process_;
  bool ended_ = false;
};

/// Solves the scene and leaves every number of the answer in a file.
int solve_into(const std::filesystem::path& store, const std::filesystem::path& answer) {
  const scene::Scene scene = press_and_release();
  Options options;
  options.store = store;
  const Result result = solve(scene, scene::tessellate(*scene::body_shape(scene.body), 64).points_m, options);
  RecordWriter bits;
  for (std::size_t i = 0; i < result.instants.size(); ++i) {
    const auto& displacement_m = result.instants[i].displacement_m;
    bits(scene::Vec3(result.instants[i].force_n()), displacement_m);
    for (const LevelRecord& level : result.levels) bits(level.force_n[i]);
  }
  scene::write_file(answer, bits.bytes());
  return 0;
}

/// Limits the size of the files this process may write, instead of killing it when it tries.
void limit_file_size(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

/// Runs a solve that must fail for want of room, and @returns what it said.
std::string refusal_of(const std::function<void()>& limit, const std::filesystem::path& store,
                       const std::filesystem::path& answer) {
  const std::filesystem::path said = answer.string() + "-said";
  Child child([&] {
    limit();
    try {
      return solve_into(store, answer);
    } catch (const std::filesystem::filesystem_error& error) {
      std::ofstream(said) << error.what();
      return 7;
    }
  });
  EXPECT_EQ(child.wait(), 7);
  return content(said);
}

class StoreCrashTest : public testing::Test {
 protected:
  StoreCrashTest()
      : root_(std::filesystem::temp_directory_path() / ("touchstone-crash-" + std::to_string(::getpid()))),
        seed_(std::random_device()()),
        random_(seed_) {
    std::filesystem::create_directories(root_);
    RecordProperty("seed", std::to_string(seed_));
  }
  ~StoreCrashTest() override { std::filesystem::remove_all(root_); }

  std::chrono::microseconds moment_within(std::chrono::microseconds span) {
    return std::chrono::microseconds(std::uniform_int_distribution<std::int64_t>(0, span.count())(random_));
  }
  std::string undisturbed() {
    Child child([&] { return solve_into(root_ / "undisturbed", root_ / "answer"); });
    EXPECT_EQ(child.wait(), 0);
    return content(root_ / "answer");
  }
  /// The answer of a run that nothing disturbs any more.
  std::string finished(const std::filesystem::path& store) {
    const std::filesystem::path answer = root_ / "finished";
    std::filesystem::remove(answer);
    Child child([&] { return solve_into(store, answer); });
    EXPECT_EQ(child.wait(), 0);
    EXPECT_EQ(unfinished_files(store), 0);
    return content(answer);
  }

  std::filesystem::path root_;
  unsigned seed_;
  std::mt19937 random_;
};

TEST_F(StoreCrashTest, AKilledWriterLosesNoStepThatWasThere) {
  constexpr int levels = 2, instants = 5, kills = 150;
  const auto expected = [](int level, int instant) {
    return std::string(20'000 + 1000 * static_cast<std::size_t>(instant), static_cast<char>('a' + level));
  };
  std::vector<char> there(levels * instants, 0);
  int leftovers = 0, killed = 0;
  for (int kill = 0; kill < kills; ++kill) {
    Child child([&] {
      const Store store(root_, "a scene", [] {});
      // Every writer begins elsewhere, so that kills soon after the start reach all steps.
      for (int turn = 3 * kill;; ++turn) {
        const int k = turn % (levels * instants);
        store.write(k / instants, k % instants, expected(k / instants, k % instants));
      }
      return 0;
    });
    std::this_thread::sleep_for(moment_within(std::chrono::milliseconds(20)));
    killed += child.kill() ? 1 : 0;
    leftovers += unfinished_files(root_);
    const Store store(root_, "a scene", never);
    EXPECT_EQ(unfinished_files(root_), 0);
    for (int k = 0; k < levels * instants; ++k) {
      const auto record = store.read(k / instants, k % instants);
      if (record) {
        EXPECT_EQ(record, expected(k / instants, k % instants));
      }
      EXPECT_TRUE(record || !there[k]) << "step " << k << " was lost by kill " << kill << ", seed " << seed_;
      there[k] = record ? 1 : 0;
    }
  }
  EXPECT_EQ(killed, kills);
  EXPECT_GT(leftovers, 0) << "no kill hit a write, so nothing was tested";
  EXPECT_EQ(std::count(there.begin(), there.end(), 1), levels * instants);
}

TEST_F(StoreCrashTest, AKilledSolveIsFinishedBitForBit) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string whole = undisturbed();
  const auto span = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin);
  ASSERT_FALSE(whole.empty());
  constexpr int rounds = 12, kills_per_round = 3;
  int killed = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::filesystem::path store = root_ / ("killed-" + std::to_string(round));
    for (int kill = 0; kill < kills_per_round; ++kill) {
      Child child([&] { return solve_into(store, root_ / "unused"); });
      std::this_thread::sleep_for(moment_within(span / kills_per_round));
      killed += child.kill() ? 1 : 0;
    }
    EXPECT_EQ(finished(store), whole) << "round " << round << ", seed " << seed_;
  }
  EXPECT_GT(killed, rounds * kills_per_round / 2) << "most solves ended before their kill, so little was tested";
}

TEST_F(StoreCrashTest, AnyDamageIsFoundAndRepairedBitForBit) {
  const std::string whole = undisturbed();
  const std::filesystem::path folder = root_ / "undisturbed" / content_key(press_and_release());
  std::vector<std::filesystem::path> steps;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".step") steps.push_back(entry.path());
  }
  std::sort(steps.begin(), steps.end());
  ASSERT_EQ(steps.size(), 18u);
  for (int round = 0; round < 6; ++round) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::filesystem::path& step = steps[k];
      const auto size = std::filesystem::file_size(step);
      switch (std::uniform_int_distribution<int>(0, 5)(random_)) {
        case 0:  // torn
          std::filesystem::resize_file(step, std::uniform_int_distribution<std::uintmax_t>(0, size - 1)(random_));
          break;
        case 1: {  // one byte altered
          std::fstream stream(step, std::ios::in | std::ios::out | std::ios::binary);
          const auto place =
              std::uniform_int_distribution<std::int64_t>(0, static_cast<std::int64_t>(size) - 1)(random_);
          stream.seekg(place);
          const char old = static_cast<char>(stream.get());
          stream.seekp(place);
          stream.put(static_cast<char>(old ^ 1));
          break;
        }
        case 2:
          std::filesystem::remove(step);
          break;
        case 3: {  // another instant's
          std::error_code missing;
          std::filesystem::copy_file(steps[(k + 1) % steps.size()], step,
                                     std::filesystem::copy_options::overwrite_existing, missing);
          break;
        }
        default:
          break;
      }
    }
    EXPECT_EQ(finished(root_ / "undisturbed"), whole) << "round " << round << ", seed " << seed_;
  }
}

TEST_F(StoreCrashTest, TwoProcessesOnOneSceneGiveTheSameBits) {
  const std::string whole = undisturbed();
  Child first([&] { return solve_into(root_ / "shared", root_ / "first"); });
  Child second([&] { return solve_into(root_ / "shared", root_ / "second"); });
  EXPECT_EQ(first.wait(), 0);
  EXPECT_EQ(second.wait(), 0);
  EXPECT_EQ(content(root_ / "first"), whole);
  EXPECT_EQ(content(root_ / "second"), whole);
}

TEST_F(StoreCrashTest, WhoWaitsGoesOnWhenTheOtherIsKilled) {
  const std::string whole = undisturbed();
  Child first([&] { return solve_into(root_ / "shared", root_ / "first"); });
  const std::filesystem::path step = root_ / "shared" / content_key(press_and_release()) / "level-1" / "instant-3.step";
  while (!std::filesystem::exists(step)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  Child second([&] { return solve_into(root_ / "shared", root_ / "second"); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  first.kill();
  EXPECT_EQ(second.wait(), 0);
  EXPECT_EQ(content(root_ / "second"), whole);
}

TEST_F(StoreCrashTest, AFileThatDoesNotFitEndsTheRunAndTheNextGoesOn) {
  const std::string whole = undisturbed();
  const std::filesystem::path store = root_ / "limited";
  // Steps of the coarse mesh fit, those of the fine one do not.
  const auto fine = std::filesystem::file_size(root_ / "undisturbed" / content_key(press_and_release()) / "level-2" /
                                               "instant-5.step");
  const std::string said = refusal_of([&] { limit_file_size(fine - 1); }, store, root_ / "limited-answer");
  EXPECT_THAT(said, HasSubstr("cannot keep this load step"));
  EXPECT_THAT(said, HasSubstr("File too large"));
  EXPECT_THAT(said, HasSubstr("level-2"));
  EXPECT_EQ(unfinished_files(store), 0);
  EXPECT_TRUE(std::filesystem::exists(store / content_key(press_and_release()) / "level-1" / "instant-9.step"));
  EXPECT_EQ(finished(store), whole);
}

TEST_F(StoreCrashTest, AFullDiskEndsTheRunAndTheNextGoesOn) {
  const std::filesystem::path disk = root_ / "disk";
  std::filesystem::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0) GTEST_SKIP() << "needs the right to mount a disk";
  const std::string whole = undisturbed();
  const std::string said = refusal_of([] {}, disk / "store", root_ / "full-answer");
  EXPECT_THAT(said, HasSubstr("No space left on device"));
  EXPECT_EQ(unfinished_files(disk), 0);
  EXPECT_EQ(::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=16m"), 0);
  EXPECT_EQ(finished(disk / "store"), whole);
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

}  // namespace
}  // namespace touchstone::reference
