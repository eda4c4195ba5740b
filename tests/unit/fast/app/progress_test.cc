// Progress as a user sees it: on a terminal of 80 columns, and in a log.
#include <gtest/gtest.h>

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "support/source_folder.h"

namespace {

const std::string scene = touchstone::source_folder() + "/meshes/scenes/pin-on-cylinder.toml";

/// The first executable that has the command, or nothing in a build without it.
std::string program_of(const std::string& verb) {
  std::istringstream in(TOUCHSTONE_VERBS);
  for (std::string one; std::getline(in, one, '|');) {
    if (one.ends_with(" " + verb)) return one;
  }
  return "";
}

/// What a command writes to a terminal of 80 columns.
std::string on_a_terminal(const std::string& command) {
  const winsize size{.ws_row = 24, .ws_col = 80, .ws_xpixel = 0, .ws_ypixel = 0};
  int master = -1;
  const pid_t child = forkpty(&master, nullptr, nullptr, &size);
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string seen;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(master, buffer, sizeof buffer)) > 0;) seen.append(buffer, static_cast<std::size_t>(n));
  close(master);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0) << seen;
  return seen;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

class ProgressTest : public testing::Test {
 protected:
  ProgressTest()
      : dir_(std::filesystem::path(testing::TempDir()) /
             (std::string("progress-") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  ~ProgressTest() override { std::filesystem::remove_all(dir_); }

  [[nodiscard]] std::string reference_command() const {
    return program_of("reference") + " " + scene + " --level 3 --set compare.instants=6 --store " +
           (dir_ / "store").string() + " --out " + (dir_ / "out").string() + " >/dev/null";
  }
  [[nodiscard]] std::string in_a_log(const std::string& command) const {
    const std::filesystem::path log = dir_ / "log.txt";
    EXPECT_EQ(std::system((command + " 2>" + log.string()).c_str()), 0);
    std::stringstream text;
    text << std::ifstream(log).rdbuf();
    return text.str();
  }

  std::filesystem::path dir_;
};

TEST_F(ProgressTest, ASolveIsOneLineThatFitsTheTerminal) {
  if (program_of("reference").empty()) GTEST_SKIP() << "a build without the reference";
  const std::string seen = on_a_terminal(reference_command());
  EXPECT_EQ(std::count(seen.begin(), seen.end(), '\n'), 1) << "one line, redrawn:\n" << seen;
  const std::vector<std::string> drawn = split(seen, '\r');
  EXPECT_GT(drawn.size(), 5u);
  for (const std::string& line : drawn) EXPECT_LT(line.size(), 80u) << line;
  EXPECT_NE(seen.find("mesh 2 of 3"), std::string::npos) << seen;
  EXPECT_NE(seen.find(" left"), std::string::npos) << seen;
}

TEST_F(ProgressTest, ALogHasALineForEveryMesh) {
  if (program_of("reference").empty()) GTEST_SKIP() << "a build without the reference";
  const std::string log = in_a_log(reference_command());
  const std::vector<std::string> lines = split(log, '\n');
  for (int mesh = 1; mesh <= 3; ++mesh) {
    const std::string begins = "mesh " + std::to_string(mesh) + " of 3 begins: ";
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [&](const auto& l) { return l.starts_with(begins); }), 1)
        << log;
  }
  const auto sensitivities = std::count_if(lines.begin(), lines.end(),
                                           [](const auto& l) { return l.find("sensitivity to") != std::string::npos; });
  EXPECT_EQ(lines.size(), 3u + static_cast<std::size_t>(sensitivities)) << log;
  EXPECT_LE(sensitivities, 6) << log;
}

TEST_F(ProgressTest, TheFastSideReachesAHundredPercent) {
  const std::string command = program_of("fast") + " " + scene + " --out " + (dir_ / "out").string() + " >/dev/null";
  const std::string end = "fast: 100 % of the track";
  const std::string seen = on_a_terminal(command);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), '\n'), 1) << seen;
  EXPECT_TRUE(seen.ends_with(end + "\r\n")) << seen;
  EXPECT_EQ(in_a_log(command), end + "\n");
}

}  // namespace
