#include "fast/command/command_line.h"

#include "scene/base/build_info.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"
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

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& what, const std::string& example,
                   VerbOptions& options, std::function<int()> action, int& exit_code) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->add_option("SCENE", options.scene_file, "scene file (TOML)")->required();
  verb->add_option("--set", options.overrides, "override a key, such as fast.C_n=0.1; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb->add_flag("--quiet", options.quiet, "no progress, only results and errors");
  verb->footer("Example:\n  " + app.get_name() + " " + name + " " + example);
  verb->callback([action = std::move(action), &exit_code] { exit_code = action(); });
  return verb;
}

void group_verbs(CLI::App& app, const std::vector<std::pair<std::string, std::vector<std::string>>>& groups) {
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) verb->group("More");
  for (const auto& [heading, verbs] : groups) {
    for (const std::string& verb : verbs) app.get_subcommand(verb)->group(heading);
  }
}

namespace {

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::string misspelt(const CLI::App& app) {
  const CLI::App* at = &app;
  std::string command = app.get_name();
  while (!at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
    command += " " + at->get_name();
  }
  for (const std::string& word : app.remaining(true)) {
    if (word.starts_with("-")) {
      const std::string option = word.substr(0, word.find('='));
      const std::string meant = scene::did_you_mean(option, options_of(*at));
      return command + ": unknown option " + option + (meant.empty() ? "; see " + command + " --help" : meant);
    }
    const std::vector<std::string> verbs = verbs_of(*at);
    if (verbs.empty()) continue;
    if (std::filesystem::is_regular_file(word)) {
      const std::string verb = std::ranges::find(verbs, "plan") != verbs.end() ? "plan" : verbs.front();
      return command + ": expected a verb before " + word + ", such as: " + command + " " + verb + " " + word;
    }
    const std::string meant = scene::did_you_mean(word, verbs);
    if (!meant.empty()) return command + ": unknown verb \"" + word + "\"" + meant;
    std::string all;
    for (const std::string& verb : verbs) all += (all.empty() ? "" : ", ") + verb;
    return command + ": unknown verb \"" + word + "\"; expected one of " + all;
  }
  return "";
}

int run_command_line(CLI::App& app, int argc, char** argv, int& exit_code) {
  app.require_subcommand(1);
  app.set_version_flag("--version",
                       std::string("Touchstone ") + scene::build_info.version + " (" + scene::build_info.commit + ")");
  const auto help = [&] {
    const std::string text = app.help();
    std::cout << text << (text.ends_with('\n') ? "" : "\n");
    return done;
  };
  if (argc == 1) return help();
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::CallForHelp&) {
    return help();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      if (const std::string message = misspelt(app); !message.empty()) {
        std::cerr << message << '\n';
        return bad_input;
      }
    }
    const int code = app.exit(error);
    return code == 0 ? done : bad_input;
  }
}

namespace {

constexpr const char* no_memory = "the memory does not suffice; expected more of it, or a smaller scene";

/// The text in one line: libraries set theirs in several.
std::string in_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// The last resort where nothing catches, as in a thread; perhaps without memory.
[[noreturn]] void say_and_end() noexcept {
  const auto end = [](const char* what) {
    std::fprintf(stderr, "cannot go on: %s\n", what);
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

/// Keeps the first file that is opened from taking the place of a standard stream that was closed. Reading and writing
/// there still fail.
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
  } catch (const std::system_error& error) {  // of files and streams, too
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
  // A stream that failed before does not try again, so its reason has to be asked for.
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
