#include "fast/command/command_line.h"

#include "scene/base/error.h"
#include "scene/input/scene_io.h"
#include "scene/model/first_contact.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace touchstone::fast {

std::filesystem::path VerbOptions::folder(const scene::Scene& scene, const std::string& verb) const {
  return out.empty() ? std::filesystem::path("out") / (scene.name + "-" + verb) : out;
}

scene::Scene VerbOptions::load() const {
  scene::Scene scene = scene::load_scene(scene_file, overrides);
  if (const std::string warning = scene::no_contact_warning(scene); !warning.empty())
    std::cerr << "warning: " << scene_file.string() << ": " << warning << '\n';
  return scene;
}

Command add_verb(Command& program, const std::string& name, const std::string& what, const std::string& example,
                 VerbOptions& options, std::function<int()> action) {
  Command verb = program.add(name, what);
  verb.option("SCENE", options.scene_file, "scene file (TOML)").required();
  verb.option("--set", options.overrides, "override a key, such as fast.C_n=0.1; may be repeated")
      .type("KEY=VALUE")
      .one_value_each_time();
  verb.flag("--quiet", options.quiet, "no progress, only results and errors");
  verb.example(name + " " + example);
  verb.action(std::move(action));
  return verb;
}

Command add_verb_with_folder(Command& program, const std::string& name, const std::string& what,
                             const std::string& example, VerbOptions& options, std::function<int()> action) {
  Command verb = add_verb(program, name, what, example, options, std::move(action));
  verb.option("--out", options.out, "result folder (default out/<scene>-" + name + ")");
  return verb;
}

namespace {

constexpr const char* no_memory = "not enough memory; expected more memory, or a smaller scene";

/// The text in one line; the messages of libraries may have several.
std::string in_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// Last resort for an uncaught exception, as in a thread; memory may be exhausted.
[[noreturn]] void say_and_end() noexcept {
  const auto end = [](const char* what) {
    std::fprintf(stderr, "cannot continue: %s\n", what);
    std::_Exit(not_converged);
  };
  try {
    if (const std::exception_ptr failure = std::current_exception()) std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    end(no_memory);
  } catch (const std::exception& error) {
    end(error.what());
  } catch (...) {
  }
  end("an unknown error");
  std::abort();
}

/// Occupies standard streams that were closed, so that no opened file takes their number. Reading and writing there
/// still fail.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace

Failure failure_at_hand() {
  try {
    throw;
  } catch (const scene::InputError& error) {
    return {bad_input, error.what()};
  } catch (const std::system_error& error) {  // also thrown by files and streams
    if (error.code() == std::errc::resource_unavailable_try_again || error.code() == std::errc::not_enough_memory) {
      return {not_converged, "no thread can be started: " + std::string(no_memory)};
    }
    return {bad_input, in_one_line(error.what())};
  } catch (const std::bad_alloc&) {
    return {not_converged, no_memory};
  } catch (const std::length_error&) {
    return {not_converged, no_memory};
  } catch (const std::exception& error) {
    return {not_converged, in_one_line(error.what())};
  } catch (...) {
    return {not_converged, "an unknown error"};
  }
}

int guarded(const std::function<int()>& program) noexcept {
  std::set_terminate(say_and_end);
  std::signal(SIGXFSZ, SIG_IGN);
  hold_standard_streams();
  int exit_code = done;
  try {
    exit_code = program();
  } catch (...) {
    const Failure failure = failure_at_hand();
    std::cerr << failure.message << '\n';
    exit_code = failure.exit_code;
  }
  errno = 0;
  const bool taken = static_cast<bool>(std::cout.flush());
  if (std::fflush(stdout) == 0 && taken) return exit_code;
  // A stream that failed before does not try again, so the reason is found by writing to the descriptor.
  if (errno == 0) static_cast<void>(!::write(STDOUT_FILENO, "\n", 1));
  std::cerr << "cannot write to standard output" << (errno != 0 ? std::string(": ") + std::strerror(errno) : "")
            << '\n';
  return exit_code == done ? bad_input : exit_code;
}

std::string shell_word(const std::string& word) {
  const bool plain = std::all_of(word.begin(), word.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-_./=+,:@%").find(c) != std::string_view::npos;
  });
  if (plain && !word.empty()) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string plan_text(const std::string& title, const scene::Plan& plan) {
  std::size_t width = 0;
  for (const scene::PlanLine& line : plan) width = std::max(width, line.part.size());
  std::string text = title + "\n";
  for (const scene::PlanLine& line : plan) {
    text += std::string(line.modelled ? "  yes  " : "  no   ") + line.part +
            std::string(width - line.part.size() + 2, ' ') + line.reason +
            (line.cost.empty() ? "" : " (" + line.cost + ")") + "\n";
  }
  return text;
}

}  // namespace touchstone::fast
