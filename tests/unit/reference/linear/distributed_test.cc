// `mpirun -np N touchstone reference SCENE` compared with the same solve by one process.
#include "reference/linear/ranks.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "scene/shape/surface.h"
#include "support/source_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace touchstone::reference {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// From /proc/<pid>/stat, "pid (name) state parent ...".
struct Process {
  char state = 'X';  // dead
  pid_t parent = -1;
};
Process process(pid_t pid) {
  const std::string stat = content(fs::path("/proc") / std::to_string(pid) / "stat");
  Process result;
  std::istringstream(stat.substr(std::min(stat.size(), stat.rfind(')') + 1))) >> result.state >> result.parent;
  return result;
}
bool runs(pid_t pid) { return process(pid).state != 'X' && process(pid).state != 'Z'; }

/// A run of `touchstone` by mpirun, with its output in a file.
class MpiRun {
 public:
  MpiRun(int ranks, const std::vector<std::string>& arguments, fs::path printed) : printed_(std::move(printed)) {
    // Also as root, on fewer and on busy processors; mpirun adds nothing to the output of touchstone.
    std::vector<std::string> words{
        MPIEXEC, "--quiet", "--oversubscribe",     "--allow-run-as-root", "--mca", "mpi_yield_when_idle",
        "1",     "-np",     std::to_string(ranks), TOUCHSTONE_BINARY};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> raw;
    for (std::string& word : words) raw.push_back(word.data());
    raw.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, printed_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    EXPECT_EQ(posix_spawn(&pid_, MPIEXEC, &actions, nullptr, raw.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
  }
  ~MpiRun() {
    if (pid_ > 0) (void)wait();
  }
  MpiRun(const MpiRun&) = delete;
  MpiRun& operator=(const MpiRun&) = delete;

  /// @returns the exit code
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  [[nodiscard]] bool ended() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_;
  }
  [[nodiscard]] std::string printed() const { return content(printed_); }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// The process of a rank, which mpirun started.
  [[nodiscard]] pid_t rank(int number) const {
    const std::string name = std::string("OMPI_COMM_WORLD_RANK=") + std::to_string(number) + '\0';
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string number_text = entry.path().filename();
      if (number_text.find_first_not_of("0123456789") != std::string::npos) continue;
      const pid_t pid = std::stoi(number_text);
      if (process(pid).parent == pid_ && content(entry.path() / "environ").find(name) != std::string::npos) return pid;
    }
    return -1;
  }

 private:
  fs::path printed_;
  pid_t pid_ = -1;
};

class Distributed : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / (std::string("distributed-") + std::to_string(getpid()) +
                                              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::vector<std::string> arguments(const std::string& file, const std::vector<std::string>& overrides,
                                                   const std::string& store) const {
    std::vector<std::string> words{
        "reference", shipped(file), "--store", (folder_ / store).string(), "--out", (folder_ / "out").string()};
    for (const std::string& text : overrides) words.insert(words.end(), {"--set", text});
    return words;
  }
  [[nodiscard]] static std::string shipped(const std::string& file) {
    return source_folder() + "/meshes/scenes/" + file;
  }
  [[nodiscard]] Result serial(const std::string& file, const std::vector<std::string>& overrides,
                              const std::string& store) const {
    const scene::Scene scene = scene::load_scene(shipped(file), overrides);
    const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), 500);
    return solve(scene, surface.points_m, {folder_ / store, {}, nullptr});
  }
  [[nodiscard]] fs::path printed() const { return folder_ / "printed"; }

  /// Waits for the first finished step of a run.
  [[nodiscard]] bool solving(const MpiRun& run, const std::string& store) const {
    while (!run.ended()) {
      if (fs::exists(folder_ / store)) {
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / store)) {
          if (entry.path().extension() == ".step") return true;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  fs::path folder_;
};

/// Expects the serial result within `tolerance_rel` of its largest force and displacement.
void expect_equal(const Result& one, const Result& other, double tolerance_rel) {
  ASSERT_EQ(one.instants.size(), other.instants.size());
  double largest_n = 0.0, largest_m = 0.0, off_n = 0.0, off_m = 0.0;
  for (std::size_t t = 0; t < one.instants.size(); ++t) {
    largest_n = std::max(largest_n, one.instants[t].force_n().norm());
    off_n = std::max(off_n, (one.instants[t].force_n() - other.instants[t].force_n()).norm());
    largest_m = std::max(largest_m, one.instants[t].displacement_m.cwiseAbs().maxCoeff());
    off_m = std::max(off_m, (one.instants[t].displacement_m - other.instants[t].displacement_m).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest_n, 0.1);
  EXPECT_LT(off_n, tolerance_rel * largest_n);
  EXPECT_LT(off_m, tolerance_rel * largest_m);
  ASSERT_EQ(one.levels.size(), other.levels.size());
  for (std::size_t level = 0; level < one.levels.size(); ++level) {
    EXPECT_EQ(one.levels[level].unknowns, other.levels[level].unknowns);
  }
}

struct Case {
  const char* name;
  const char* file;
  std::vector<std::string> overrides;
  const char* model;  // a word of its description
  int ranks;
};

class DistributedAnswer : public Distributed, public testing::WithParamInterface<Case> {};

TEST_P(DistributedAnswer, IsTheSerialOneAndEitherFindsTheOthers) {
  const Case& param = GetParam();
  {
    MpiRun run(param.ranks, arguments(param.file, param.overrides, "theirs"), printed());
    ASSERT_EQ(run.wait(), 0) << run.printed();
    EXPECT_THAT(run.printed(), HasSubstr("Force at the deepest instant"));
  }
  const Result theirs = serial(param.file, param.overrides, "theirs");
  EXPECT_TRUE(theirs.from_store);
  EXPECT_THAT(theirs.model, HasSubstr(param.model));
  EXPECT_THAT(theirs.linear_solver, HasSubstr("on " + std::to_string(param.ranks) + " processes"));
  const Result ours = serial(param.file, param.overrides, "ours");
  EXPECT_FALSE(ours.from_store);
  EXPECT_THAT(ours.linear_solver, HasSubstr("CHOLMOD"));
  expect_equal(ours, theirs, 1e-8);
  MpiRun again(param.ranks, arguments(param.file, param.overrides, "ours"), printed());
  ASSERT_EQ(again.wait(), 0) << again.printed();
  EXPECT_THAT(again.printed(), HasSubstr("from the store"));
}

const std::vector<std::string> coarse_quarter{"reference.levels=1", "reference.element_size_m=0.004",
                                              "compare.instants=5"};
const std::vector<std::string> coarse_ball{"reference.levels=1", "reference.element_size_m=0.002", "compare.instants=4",
                                           "body.inclusion=[{shape=\"sphere\", radius_m=0.008, center_m=[0, 0, 0.04],"
                                           " material={youngs_modulus_pa=3.4e4, poissons_ratio=0.33}}]"};
const auto name_of = [](const auto& instance) { return std::string(instance.param.name); };
INSTANTIATE_TEST_SUITE_P(Scenes, DistributedAnswer,
                         testing::Values(Case{"AxisymmetricWithInclusionOnTwo", "sphere-on-sphere-body.toml",
                                              coarse_ball, "axisymmetric", 2}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(SpaceScenes, DistributedAnswer,
                         testing::Values(Case{"QuarterOnTwo", "ball-on-cube-press.toml", coarse_quarter, "quarter", 2},
                                         Case{"QuarterOnThree", "ball-on-cube-press.toml", coarse_quarter, "quarter",
                                              3}),
                         name_of);

TEST(Alone, AStartWithoutMpirunDoesNotTouchMpi) {
  unsetenv("OMPI_COMM_WORLD_SIZE");
  unsetenv("PMIX_RANK");
  const ranks::Session session;
  int initialized = 1;
  MPI_Initialized(&initialized);
  EXPECT_EQ(initialized, 0);
  EXPECT_EQ(ranks::count(), 1);
  EXPECT_TRUE(ranks::first());
  EXPECT_EQ(ranks::on_this_machine(), 1);
}

TEST_F(Distributed, BadInputIsOneErrorAndExitsWithTwo) {
  MpiRun run(2, arguments("ball-on-cube-press.toml", {"reference.levels=99"}, "store"), printed());
  EXPECT_EQ(run.wait(), 2);
  // Once, whatever the number of ranks; a container's MPI may print something before it.
  const std::string text = run.printed(), message = "expected a whole number in [1, 9]";
  EXPECT_THAT(text, HasSubstr("reference.levels = 99; " + message));
  EXPECT_EQ(text.find(message), text.rfind(message)) << text;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Distributed, NotConvergedIsOneErrorAndExitsWithThree) {
  // A pin pressed too deep for cells as large as its radius.
  MpiRun run(2,
             arguments("pin-on-cylinder.toml",
                       {"reference.levels=1", "reference.element_size_m=0.004", "compare.instants=2",
                        "track=[{time_s=0, position_m=[0, 0, 0.0555]}, {time_s=1, position_m=[0, 0, 0.042]}]"},
                       "store"),
             printed());
  EXPECT_EQ(run.wait(), 3) << run.printed();
  const std::string text = run.printed(), message = "did not converge";
  EXPECT_THAT(text, HasSubstr(message));
  EXPECT_EQ(text.find(message), text.rfind(message)) << text;
}

TEST_F(Distributed, AnInterruptKeepsFinishedStepsAndTheNextRunGoesOn) {
  const std::vector<std::string> many{"reference.levels=1", "reference.element_size_m=0.002", "compare.instants=60"};
  const auto words = arguments("sphere-on-sphere-body.toml", many, "store");
  {
    MpiRun run(2, words, printed());
    ASSERT_TRUE(solving(run, "store")) << run.printed();
    kill(run.rank(0), SIGTERM);
    EXPECT_EQ(run.wait(), 130) << run.printed();
    EXPECT_THAT(run.printed(), HasSubstr("interrupted; every finished load step is in the store"));
  }
  MpiRun run(2, words, printed());
  EXPECT_EQ(run.wait(), 0) << run.printed();
  EXPECT_THAT(run.printed(), testing::ContainsRegex("mesh 1 of .*resumed: [0-9]+ unknowns, instant "));
  expect_equal(serial("sphere-on-sphere-body.toml", many, "other"), serial("sphere-on-sphere-body.toml", many, "store"),
               1e-8);
}

TEST_F(Distributed, ARankThatDiesTakesTheOthersWithItAndLeavesAStoreToGoOnFrom) {
  const std::vector<std::string> many{"reference.levels=1", "reference.element_size_m=0.002", "compare.instants=60"};
  MpiRun run(3, arguments("sphere-on-sphere-body.toml", many, "store"), printed());
  ASSERT_TRUE(solving(run, "store")) << run.printed();
  const std::vector<pid_t> ranks{run.rank(0), run.rank(1), run.rank(2)};
  ASSERT_THAT(ranks, testing::Each(testing::Gt(0)));
  kill(ranks[1], SIGKILL);
  EXPECT_NE(run.wait(), 0);
  for (const pid_t pid : ranks) {
    while (runs(pid)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const Result result = serial("sphere-on-sphere-body.toml", many, "store");
  EXPECT_THAT(result.linear_solver, HasSubstr("CHOLMOD"));  // of the last step, solved alone
  EXPECT_GT(result.instants.back().force_n().norm(), 0.1);
}

}  // namespace
}  // namespace touchstone::reference
