// Ways in which a program ends: every failure is one message and an exit code.
#include "fast/command/command_line.h"
#include "fast/command/stop_signals.h"
#include "scene/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <iostream>
#include <new>
#include <stdexcept>
#include <thread>

namespace touchstone::fast {
namespace {

/// @param thrown  by the program
template <class Error>
void expect_end(const Error& thrown, int exit_code, const std::string& message) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(guarded([&]() -> int { throw thrown; }), exit_code);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), message);
}

TEST(Guard, EveryExceptionIsAMessageAndAnExitCode) {
  expect_end(scene::InputError("a = 3; expected 2"), bad_input, "a = 3; expected 2\n");
  expect_end(
      std::filesystem::filesystem_error("cannot write", "/x", std::make_error_code(std::errc::no_space_on_device)),
      bad_input, "filesystem error: cannot write: No space left on device [/x]\n");
  expect_end(std::ios_base::failure("cannot read"), bad_input, "cannot read: iostream error\n");
  const std::string memory = "not enough memory; expected more memory, or a smaller scene\n";
  expect_end(std::bad_alloc(), not_converged, memory);
  expect_end(std::length_error("vector"), not_converged, memory);
  expect_end(std::runtime_error("two\n   lines\n"), not_converged, "two lines\n");
  expect_end(3, not_converged, "an unknown error\n");
  EXPECT_EQ(guarded([] { return 1; }), 1);
}

TEST(Guard, AFailureThatNothingCatchesIsAMessageAndAnExitCode) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(static_cast<void>(guarded([] {
                std::thread([] { throw std::bad_alloc(); }).join();
                return 0;
              })),
              testing::ExitedWithCode(not_converged), "^cannot continue: not enough memory; expected [^\n]*\n$");
  EXPECT_EXIT(static_cast<void>(guarded([]() -> int { std::terminate(); })), testing::ExitedWithCode(not_converged),
              "^cannot continue: an unknown error\n$");
}

TEST(Guard, TextThatIsNotTakenIsAFailure) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto print = [](const char* to, int ends) {
    if (to == nullptr) {
      ::close(STDOUT_FILENO);
    } else {
      static_cast<void>(std::freopen(to, "w", stdout));
    }
    std::_Exit(guarded([&] {
      std::cout << "an answer\n";
      return ends;
    }));
  };
  EXPECT_EXIT(print("/dev/full", done), testing::ExitedWithCode(bad_input),
              "^cannot write to standard output: No space left on device\n$");
  EXPECT_EXIT(print(nullptr, done), testing::ExitedWithCode(bad_input),
              "^cannot write to standard output: Bad file descriptor\n$");
  EXPECT_EXIT(print("/dev/full", interrupted), testing::ExitedWithCode(interrupted), "No space left");
  EXPECT_EXIT(print("/dev/null", done), testing::ExitedWithCode(done), "^$");
}

TEST(EndSignals, EndTheProcessWithASentenceWhileItLives) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          const EndSignals signals("interrupted here");
          std::raise(signal);
        },
        ::testing::ExitedWithCode(130), "^interrupted here\n$");
    EXPECT_EXIT(
        {
          { const EndSignals signals("interrupted here"); }
          std::raise(signal);
        },
        ::testing::KilledBySignal(signal), "^$");
  }
}

TEST(StopSignals, AreARequestWhileItLives) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    {
      const StopSignals signals(StopSignals::Again::nothing);
      EXPECT_FALSE(StopSignals::asked());
      std::raise(SIGPIPE);
      EXPECT_FALSE(StopSignals::asked());
      std::raise(signal);
      std::raise(signal);
      EXPECT_TRUE(StopSignals::asked());
    }
    EXPECT_EXIT(std::raise(signal), testing::KilledBySignal(signal), "");
    const auto twice = [signal] {
      const StopSignals signals(StopSignals::Again::end_at_once);
      std::raise(signal);
      std::raise(signal);
    };
    EXPECT_EXIT(twice(), testing::KilledBySignal(signal), "");
  }
  // As when started by nohup.
  std::signal(SIGHUP, SIG_IGN);
  const StopSignals signals(StopSignals::Again::nothing);
  std::raise(SIGHUP);
  EXPECT_FALSE(StopSignals::asked());
  std::signal(SIGHUP, SIG_DFL);
}

}  // namespace
}  // namespace touchstone::fast
