#include "fast/command_line.h"

#include "scene/build_info.h"
#include "scene/error.h"
#include "scene/first_contact.h"
#include "scene/nearest_name.h"
#include "scene/scene_io.h"

#include <algorithm>
#include <cctype>
#include <iostream>

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
  } catch (const scene::InputError& error) {
    std::cerr << error.what() << '\n';
    return bad_input;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << error.what() << '\n';
    return bad_input;
  }
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
