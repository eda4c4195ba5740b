// The progress line on a terminal of 80 columns and in a file.
#include "fast/command/progress_line.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace touchstone::fast {
namespace {

using namespace std::chrono_literals;

/// A pseudo-terminal of our own.
class Terminal {
 public:
  explicit Terminal(unsigned short columns) {
    winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    if (openpty(&master_, &slave_, nullptr, nullptr, &size) != 0) throw std::runtime_error("no pseudo-terminal");
    fcntl(master_, F_SETFL, O_NONBLOCK);
  }
  ~Terminal() {
    close(master_);
    close(slave_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] int file() const { return slave_; }
  void resize(unsigned short columns) const {
    const winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    ASSERT_EQ(ioctl(slave_, TIOCSWINSZ, &size), 0);
  }
  /// All that has been written to it since the last call.
  [[nodiscard]] std::string seen() const {
    std::string text;
    char buffer[4096];
    for (ssize_t n = 0; (n = read(master_, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<size_t>(n));
    return text;
  }

 private:
  int master_ = -1, slave_ = -1;
};

/// The text of each redrawing of the line, without the blanks that erase an earlier one.
std::vector<std::string> redrawings(const std::string& seen) {
  std::vector<std::string> list;
  std::istringstream in(seen);
  for (std::string part; std::getline(in, part, '\r');) {
    if (!part.empty()) list.push_back(part.substr(0, part.find_last_not_of(' ') + 1));
  }
  return list;
}

TEST(ProgressLine, FitsTheTerminalAndIsRedrawnInPlace) {
  const Terminal terminal(80);
  {
    ProgressLine line(false, terminal.file(), 1min);
    line.show(std::string(100, 'a'), true);
    line.show("short", true);
    const std::string seen = terminal.seen();
    EXPECT_EQ(seen.find('\n'), std::string::npos) << "redrawn in place, not below";
    EXPECT_EQ(redrawings(seen), (std::vector<std::string>{std::string(76, 'a') + "...", "short"}));
    // The second erases the first.
    EXPECT_EQ(seen.substr(seen.rfind('\r') + 1), "short" + std::string(74, ' '));
  }
  EXPECT_EQ(terminal.seen(), "\r\n") << "what follows begins on a line of its own";
}

TEST(ProgressLine, FollowsTheTerminalsWidth) {
  const Terminal terminal(80);
  ProgressLine line(false, terminal.file(), 1min);
  line.show(std::string(70, 'a'), true);
  EXPECT_EQ(redrawings(terminal.seen()).back(), std::string(70, 'a'));
  terminal.resize(40);
  line.show(std::string(70, 'b'), true);
  const std::string seen = terminal.seen();
  EXPECT_EQ(redrawings(seen).back(), std::string(36, 'b') + "...");
  EXPECT_LE(seen.size(), 1 + 39u) << "blanks do not wrap, either";
}

TEST(ProgressLine, ATerminalIsNotFlooded) {
  const Terminal terminal(80);
  ProgressLine line(false, terminal.file(), 1min);
  for (int i = 0; i < 1000; ++i) line.show("iteration " + std::to_string(i));
  EXPECT_LT(redrawings(terminal.seen()).size(), 100u);
}

TEST(ProgressLine, QuietSaysNothing) {
  const Terminal terminal(80);
  {
    ProgressLine line(true, terminal.file(), 0s);
    line.show("text", true);
  }
  EXPECT_EQ(terminal.seen(), "");
}

TEST(ProgressLine, ALogHasTheMarkedLinesAndAHeartbeat) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "progress-line.log";
  const int file = open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  {
    ProgressLine line(false, file, 200ms);
    line.show("mesh 1", true);
    for (int i = 0; i < 100; ++i) line.show("too soon");
    line.show("mesh 1", true);
    std::this_thread::sleep_for(210ms);
    line.show("heartbeat " + std::string(200, 'x'));
    line.show("too soon");
    line.show("mesh 2", true);
  }
  close(file);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "mesh 1\nheartbeat " + std::string(200, 'x') + "\nmesh 2\n") << "and nothing is cut off";
  std::filesystem::remove(path);
}

TEST(ProgressLine, CutsBetweenCharacters) {
  EXPECT_EQ(cut_to_width("abcdef", 6), "abcdef");
  EXPECT_EQ(cut_to_width("abcdefg", 6), "abc...");
  EXPECT_EQ(cut_to_width("\u00e4\u00e4\u00e4\u00e4", 4), "\u00e4\u00e4\u00e4\u00e4");
  EXPECT_EQ(cut_to_width("\u00e4\u00e4\u00e4\u00e4\u00e4", 4), "\u00e4...");
  EXPECT_EQ(cut_to_width("abcdef", 2), "..");
}

}  // namespace
}  // namespace touchstone::fast
