#include "fast/command/command.h"

#include "fast/command/exit_code.h"
#include "scene/base/build_info.h"
#include "scene/base/nearest_name.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <optional>

namespace touchstone::fast {
namespace {

std::vector<CLI::App*> commands_of(CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The message for a misspelt command or option, with the nearest known one; empty for another fault.
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
      const std::string meant = scene::did_you_mean(option, names_of_options(*at));
      return command + ": unknown option " + option + (meant.empty() ? "; see " + command + " --help" : meant);
    }
    const std::vector<std::string> verbs = names_of_commands(*at);
    if (verbs.empty()) continue;
    if (std::filesystem::is_regular_file(word)) {
      const std::string verb = std::ranges::find(verbs, "plan") != verbs.end() ? "plan" : verbs.front();
      return command + ": expected a command before " + word + ", such as: " + command + " " + verb + " " + word;
    }
    const std::string meant = scene::did_you_mean(word, verbs);
    if (!meant.empty()) return command + ": unknown command \"" + word + "\"" + meant;
    std::string all;
    for (const std::string& verb : verbs) all += (all.empty() ? "" : ", ") + verb;
    return command + ": unknown command \"" + word + "\"; expected one of " + all;
  }
  return "";
}

CommandWords words_of(const CLI::App& app) {
  CommandWords words{app.get_name(), app.get_description(), {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    const bool argument = !option->nonpositional();
    if (!argument && option->get_lnames().empty()) continue;
    words.values.push_back({argument ? option->get_name(true) : "--" + option->get_lnames().front(),
                            option->get_type_name(), argument, option->get_items_expected_max() > 0});
  }
  for (const CLI::App* below : commands_of(app)) words.below.push_back(words_of(*below));
  return words;
}

}  // namespace

Option Option::required() const { return Option(option_->required()); }
Option Option::range(int least, int largest) const { return Option(option_->check(CLI::Range(least, largest))); }
Option Option::range(double least, double largest) const { return Option(option_->check(CLI::Range(least, largest))); }
Option Option::positive() const { return Option(option_->check(CLI::PositiveNumber)); }
Option Option::one_of(std::vector<std::string> words) const {
  return Option(option_->check(CLI::IsMember(std::move(words))));
}
Option Option::values(int count) const { return Option(option_->expected(count)); }
Option Option::one_value_each_time() const { return Option(option_->allow_extra_args(false)); }
Option Option::type(const std::string& shown) const { return Option(option_->type_name(shown)); }
Option Option::shows_default() const { return Option(option_->capture_default_str()); }
Option Option::needs(const Option& other) const { return Option(option_->needs(other.option_)); }
Option Option::excludes(const Option& other) const { return Option(option_->excludes(other.option_)); }

Command Command::add(const std::string& name, const std::string& what) {
  app_->require_subcommand(1);
  return {app_->add_subcommand(name, what), root_, exit_code_};
}

template <class T>
Option Command::option(const std::string& name, T& value, const std::string& what) {
  return Option(app_->add_option(name, value, what));
}
template Option Command::option(const std::string&, std::filesystem::path&, const std::string&);
template Option Command::option(const std::string&, std::string&, const std::string&);
template Option Command::option(const std::string&, int&, const std::string&);
template Option Command::option(const std::string&, double&, const std::string&);
template Option Command::option(const std::string&, std::int64_t&, const std::string&);
template Option Command::option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::option(const std::string&, std::optional<int>&, const std::string&);
template Option Command::option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::filesystem::path>&, const std::string&);

Option Command::option(const std::string& name, std::function<std::string(const std::string&)> take,
                       const std::string& what) {
  return Option(app_->add_option_function<std::string>(
      name,
      [name, take = std::move(take)](const std::string& word) {
        if (const std::string fault = take(word); !fault.empty()) throw CLI::ValidationError(name, fault);
      },
      what));
}

Option Command::flag(const std::string& name, bool& value, const std::string& what) {
  return Option(app_->add_flag(name, value, what));
}

void Command::prints(const std::string& flag, std::function<std::string()> text, const std::string& what) {
  app_->add_flag_callback(
      flag,
      [text = std::move(text)] {
        std::cout << text();
        throw CLI::Success();
      },
      what);
}

void Command::example(const std::string& call) { app_->footer("Example:\n  " + program_name() + " " + call); }

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::action(std::function<int()> action) {
  app_->callback([action = std::move(action), code = exit_code_] { *code = action(); });
}

std::string Command::program_name() const { return root_->get_name(); }

Program::Program(const std::string& what, const std::string& name)
    : Command(nullptr, nullptr, &code_), owned_(std::make_unique<CLI::App>(what, name)) {
  app_ = root_ = owned_.get();
  app_->set_version_flag(
      "--version", std::string("Touchstone ") + scene::build_info.version + " (" + scene::build_info.commit + ")");
}

Program::~Program() = default;

void Program::group(const std::vector<std::pair<std::string, std::vector<std::string>>>& groups) {
  for (CLI::App* command : commands_of(*app_)) command->group("More");
  for (const auto& [heading, names] : groups) {
    for (const std::string& name : names) app_->get_subcommand(name)->group(heading);
  }
}

CommandWords Program::words() const { return words_of(*owned_); }

int Program::run(int argc, char** argv) {
  const auto help = [&] {
    const std::string text = app_->help();
    std::cout << text << (text.ends_with('\n') ? "" : "\n");
    return done;
  };
  if (argc == 1 && !commands_of(*app_).empty()) return help();
  try {
    app_->parse(argc, argv);
    return code_;
  } catch (const CLI::CallForHelp&) {
    return help();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      if (const std::string message = misspelt(*app_); !message.empty()) {
        std::cerr << message << '\n';
        return bad_input;
      }
    }
    const int code = app_->exit(error);
    return code == 0 ? done : bad_input;
  }
}

}  // namespace touchstone::fast
