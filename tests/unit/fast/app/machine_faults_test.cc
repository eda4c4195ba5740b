// Faults of the machine during a run: no disk space, memory or descriptors, a closed output, signals, another writer.
// Every command ends at once with one sentence and an exit code, loses nothing that was finished, and works the next
// time.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/source_folder.h"

namespace {

using std::filesystem::path;
using testing::AnyOf;
using testing::ContainsRegex;
using testing::Eq;
using testing::HasSubstr;

const std::string source = touchstone::source_folder();

std::string text_of(const path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// How a run ended.
struct End {
  int exit_code = -1;  ///< 128 + the signal that ended it, as in a shell
  std::string output, errors;
  double seconds = 0.0;
};

/// A command on a small scene.
struct Case {
  std::string program, verb;
  [[nodiscard]] bool full() const { return !program.ends_with("touchstone-fast"); }
};

std::vector<Case> cases() {
  std::vector<Case> list;
  std::istringstream in(TOUCHSTONE_VERBS);
  for (std::string verb; std::getline(in, verb, '|');) {
    const std::size_t space = verb.rfind(' ');
    const std::string program = verb.substr(0, space), name = verb.substr(space + 1);
    if (program.ends_with("touchstone-fast")) list.push_back({program, name});
    if (name != "compare") continue;
    for (const char* other : {"compare", "tune", "trade", "gate", "study"}) list.push_back({program, other});
  }
  return list;
}

/// Those that solve a reference anew, or the others.
std::vector<Case> cases(bool solving) {
  std::vector<Case> list = cases();
  std::erase_if(list, [&](const Case& one) { return (one.verb == "compare" || one.verb == "trade") != solving; });
  return list;
}

class MachineFaults : public testing::TestWithParam<Case> {
 protected:
  MachineFaults()
      : dir_(path(testing::TempDir()) / ("machine-faults-" + std::to_string(::getpid()) + "-" + GetParam().verb)) {
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
    const std::string set = "{ compare.instants = 2, fast.triangles = 300, reference.element_size_m = 1e-3 }";
    const std::string scene = "scene = \"" + scene_ + "\"\nset = " + set + "\n";
    std::ofstream(dir_ / "tune.toml") << "kind = \"tuning\"\nformulation = [\"published\"]\nlaw = [\"duffing\"]\n"
                                      << "[[training]]\nname = \"a\"\n"
                                      << scene << "[[held_out]]\nname = \"b\"\ndiffers = \"depth\"\n"
                                      << scene
                                      << "[[parameter]]\nkey = \"contact.k1_n_per_m\"\nbounds = [160.0, 1e6]\n"
                                         "start = 4e4\n";
    std::ofstream(dir_ / "study.toml") << "scene = \"" << scene_ << "\"\nrun = \"fast\"\n[set]\nfast.triangles = 300\n"
                                       << "compare.instants = 2\n[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.1]\n";
    if (GetParam().verb == "study") {
      EXPECT_EQ(run("", GetParam().program + " study expand study.toml --out study").exit_code, 0);
      for (const auto& entry : std::filesystem::directory_iterator(dir_ / "study" / "scenes")) {
        out_ = dir_ / "study" / "results" / entry.path().stem();
      }
    }
  }
  ~MachineFaults() override { std::filesystem::remove_all(dir_); }

  [[nodiscard]] std::string command() const {
    const std::string &program = GetParam().program, &verb = GetParam().verb;
    const std::string start = program + " " + verb + " ", out = " --quiet --out " + out_.string();
    const std::string small = scene_ + " --set compare.instants=2 --set fast.triangles=300";
    const std::string solve = " --set reference.element_size_m=1e-3 --level 1 --store store";
    if (verb == "fast") return start + small + out;
    if (verb == "live") return start + small + " --seconds 0.3" + out;
    if (verb == "gate") return start + "pin-on-cylinder.force --gates " + source + "/tests/gates" + out;
    if (verb == "tune") return start + "tune.toml --level 1 --store store" + out;
    if (verb == "study") return start + "run study --index 1 --quiet";
    return start + small + solve + (verb == "trade" ? " --quick" : "") + out;
  }

  /// In the test's folder. @param before  shell words, such as limits; @param after  redirections
  /// @param signal  sent some time after the start
  End run(const std::string& before, const std::string& command, const std::string& after = "", int signal = 0,
          double signal_s = 0.0) const {
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const std::string shell = "cd " + dir_.string() + "; exec 2>errors >output; export OMP_NUM_THREADS=1; " + before +
                              " exec " + command + " " + after;
    const pid_t child = ::fork();
    if (child == 0) {
      ::execl("/bin/sh", "sh", "-c", shell.c_str(), nullptr);
      ::_exit(127);
    }
    int status = 0;
    bool sent = false;
    while (::waitpid(child, &status, WNOHANG) == 0) {
      if (signal != 0 && !sent && seconds() > signal_s) sent = ::kill(child, signal) == 0;
      if (seconds() > 300.0) ::kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(dir_ / "output"),
            text_of(dir_ / "errors"), seconds()};
  }

  /// One run of the command; a study must consider it not done.
  End run_verb(const std::string& before, const std::string& after = "", int signal = 0, double signal_s = 0.0) const {
    std::filesystem::remove(out_ / "done.json");
    return run(before, command(), after, signal, signal_s);
  }

  /// The sentence with which a run ended: the only line of its error output apart from warnings; for a study, what it
  /// says about the case.
  [[nodiscard]] std::string sentence(const End& end) const {
    std::istringstream in(end.errors.empty() ? end.output.substr(end.output.rfind("failed: ") + 1) : end.errors);
    std::string sentence;
    for (std::string line; std::getline(in, line);) {
      // FCL prints its own message about memory.
      if (line.starts_with("warning: ") || line.starts_with("BVH Error!")) continue;
      EXPECT_EQ(sentence, "") << "more than one line: " << end.errors;
      sentence = line;
    }
    EXPECT_NE(sentence, "") << "no word: " << end.output;
    return sentence;
  }

  /// Everything that was finished exists and is complete, whoever wrote it.
  void expect_results() const {
    for (const char* name : {"summary.json", "manifest.json"}) {
      EXPECT_TRUE(nlohmann::json::accept(text_of(out_ / name))) << out_ / name;
    }
  }
  void expect_no_unfinished_file() const {
    for (const auto& entry : std::filesystem::directory_iterator(out_)) {
      EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr(".touchstone-part-")));
    }
  }

  const std::string scene_ = source + "/meshes/scenes/pin-on-cylinder.toml";
  path dir_, out_ = dir_ / "out";
};

INSTANTIATE_TEST_SUITE_P(Verbs, MachineFaults, testing::ValuesIn(cases(false)),
                         [](const auto& one) { return one.param.verb; });
INSTANTIATE_TEST_SUITE_P(SolvingVerbs, MachineFaults, testing::ValuesIn(cases(true)),
                         [](const auto& one) { return one.param.verb; });

TEST_P(MachineFaults, EndInASentenceAndTheNextRunWorks) {
  const End first = run_verb("");
  ASSERT_EQ(first.exit_code, 0) << first.errors << first.output;
  expect_results();

  struct Fault {
    std::string name, before, after, sentence;
    std::vector<int> exit_codes;
  };
  // Faults of the output and of descriptors are handled by one part of the program, whatever the command.
  const bool every = GetParam().verb == "fast" || GetParam().verb == "live" || GetParam().verb == "compare";
  std::vector<Fault> faults = {
      {"no space for a file", "ulimit -f 1;", "", "cannot write: File too large \\[", {2}},
      {"no space for the output", "", ">/dev/full", "cannot write to standard output: No space left on device", {2}},
      {"a closed output", "", ">&-", "cannot write to standard output", {2}},
      {"few descriptors", "ulimit -n 5;", "", "Too many open files|cannot open shared object file", {2, 3, 127}},
  };
  if (TOUCHSTONE_SANITIZED) faults.pop_back();  // the sanitizers need descriptors of their own
  if (!every) faults.resize(1);
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    const End end = run_verb(fault.before, fault.after);
    EXPECT_THAT(fault.exit_codes, testing::Contains(end.exit_code)) << end.errors << end.output;
    EXPECT_THAT(sentence(end), ContainsRegex(fault.sentence));
    expect_results();
    expect_no_unfinished_file();
  }

  {
    SCOPED_TRACE("another writer");
    const int lock = ::open((out_ / ".touchstone-writer").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
    const std::string before = text_of(out_ / "summary.json");
    const End end = run_verb("");
    EXPECT_EQ(end.exit_code, 2) << end.errors;
    EXPECT_THAT(sentence(end), HasSubstr("another run is writing there; expected a folder of its own"));
    EXPECT_EQ(text_of(out_ / "summary.json"), before);
    ::close(lock);
  }

  double wait_s = 0.7 * first.seconds;
  for (const int signal : every ? std::vector{SIGINT, SIGTERM, SIGHUP, SIGKILL} : std::vector{SIGTERM, SIGKILL}) {
    SCOPED_TRACE("signal " + std::to_string(signal));
    End end;
    for (int tries = 0; tries < 4; ++tries) {
      end = run_verb("", "", signal, wait_s);
      if (end.exit_code != 0) break;
      // It had ended before: the first run also makes what later ones find.
      wait_s = 0.5 * std::min(wait_s, end.seconds);
    }
    EXPECT_THAT(end.exit_code, AnyOf(Eq(130), Eq(128 + signal))) << end.errors;
    expect_results();
  }
  const End next = run_verb("");
  EXPECT_EQ(next.exit_code, 0) << next.errors << next.output;
  expect_results();
  expect_no_unfinished_file();
}

TEST_P(MachineFaults, AFolderThatCannotBeWrittenToIsRefused) {
  std::ofstream(dir_ / "file") << "x";
  out_ = GetParam().verb == "study" ? dir_ / "none" : dir_ / "file" / "out";
  if (GetParam().verb == "study") {
    std::filesystem::remove_all(dir_ / "study" / "results");
    std::filesystem::create_symlink(dir_ / "file", dir_ / "study" / "results");
  }
  const End end = run("", command());
  EXPECT_EQ(end.exit_code, 2) << end.errors;
  EXPECT_THAT(sentence(end), HasSubstr("expected a folder that can be written to"));
}

TEST_P(MachineFaults, LackOfMemoryIsSaid) {
  if (GetParam().full() && GetParam().verb != "compare") GTEST_SKIP() << "the same as compare: when the program starts";
  if (TOUCHSTONE_SANITIZED) GTEST_SKIP() << "the sanitizer takes all the addresses there are";
  const std::vector<int> limits_mib = GetParam().full() ? std::vector{720, 1000} : std::vector{24, 28, 36, 44};
  for (const int limit_mib : limits_mib) {
    SCOPED_TRACE(std::to_string(limit_mib) + " MiB");
    const End end = run_verb("ulimit -v " + std::to_string(1024 * limit_mib) + ";");
    EXPECT_LT(end.seconds, 40.0);
    if (end.exit_code == 0) continue;
    EXPECT_THAT(end.exit_code, AnyOf(Eq(2), Eq(3), Eq(127))) << end.errors << end.output;
    EXPECT_THAT(sentence(end), ContainsRegex("memory|map segment|shared object")) << end.output;
  }
}

TEST(MachineFaultsLive, OfTwoWritersTheSecondIsRefusedAndTheFirstGoesOn) {
  for (const Case& one : cases()) {
    if (one.verb != "live") continue;
    const path dir = path(testing::TempDir()) / ("two-writers-" + std::to_string(::getpid()));
    std::filesystem::remove_all(dir);
    const std::string command = one.program + " live " + source +
                                "/meshes/scenes/ball-on-cube-press.toml --quiet --out " + dir.string() +
                                " --seconds 1.1 >/dev/null 2>/dev/null";
    const std::string shell = "( " + command + "; exit $? ) & first=$!; while [ ! -e " + dir.string() +
                              "/live.csv.touchstone-part-* ]; do sleep 0.02; done; " + command +
                              "; second=$?; wait $first && [ $second = 2 ]";
    EXPECT_EQ(std::system(shell.c_str()), 0);
    std::ifstream log(dir / "live.csv");
    std::string line;
    std::getline(log, line);
    double last_s = -1.0;
    int rows = 0;
    for (; std::getline(log, line); ++rows) {
      const double time_s = std::stod(line);
      EXPECT_GT(time_s, last_s) << "row " << rows;
      last_s = time_s;
    }
    EXPECT_GT(rows, 100);
    std::filesystem::remove_all(dir);
  }
}

TEST(MachineFaultsLive, RunsWhateverTheLimitForStacksAndTakesNoMoreMemoryForIt) {
  for (Case one : cases()) {
    // The other program's libraries have threads of their own, and it has the command, too.
    if (one.verb == "compare") one.verb = "live";
    if (one.verb != "live") continue;
    const path dir = path(testing::TempDir()) / ("stacks-" + std::to_string(::getpid()));
    for (const int limit_kib : {128, 8 << 10, 20 << 10, 4 << 20}) {
      SCOPED_TRACE(one.program + " " + std::to_string(limit_kib) + " KiB");
      const std::string shell = "ulimit -s " + std::to_string(limit_kib) + "; exec " + one.program + " live " + source +
                                "/meshes/scenes/pin-on-cylinder.toml --quiet --seconds 0.1 --out " + dir.string() +
                                " >/dev/null 2>/dev/null";
      const pid_t child = ::fork();
      if (child == 0) {
        ::execl("/bin/sh", "sh", "-c", shell.c_str(), nullptr);
        ::_exit(127);
      }
      int status = 0;
      rusage used{};
      ASSERT_EQ(::wait4(child, &status, 0, &used), child);
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
      if (!TOUCHSTONE_SANITIZED) {
        EXPECT_LT(used.ru_maxrss, one.full() ? 1'200'000 : 60'000) << "KiB";
      }
    }
    std::filesystem::remove_all(dir);
  }
}

}  // namespace
