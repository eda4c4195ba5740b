#include "fast/app/completion.h"

#include "fast/command/command_line.h"
#include "scene/input/fields.h"

#include <algorithm>
#include <iostream>
#include <vector>

namespace touchstone::fast {
namespace {

/// What the shell completes at a place of the command line.
enum class Expects { nothing, keys, toml_files, folders, files, words };

struct Place {
  std::string name;  ///< an option; empty for a positional argument
  Expects expects = Expects::nothing;
  std::string words;
};

struct VerbWords {
  std::string name, what;  ///< such as "study expand"
  std::string options;     ///< and subcommands
  std::vector<Place> values;
  Place alone;
};

Place place_of(const CommandWords::Value& value) {
  const std::string& name = value.name;
  const auto starts = [&](const char* with) { return value.type.starts_with(with); };
  if (value.argument) {
    if (name == "SCENE" || name == "STUDY") return {"", Expects::toml_files, ""};
    if (name == "DIR") return {"", Expects::folders, ""};
    if (name == "SHELL") return {"", Expects::words, "bash zsh"};
    return {"", name == "FILE" ? Expects::files : Expects::nothing, ""};
  }
  // A text argument is usually a path; numbers and lengths have types of their own.
  Place place{name, starts("TEXT") ? Expects::files : Expects::nothing, ""};
  if (starts("KEY=VALUE")) {
    place.expects = Expects::keys;
  } else if (value.type.find('|') != std::string::npos) {
    place.expects = Expects::words;
    place.words = value.type.substr(0, value.type.find(' '));
    std::ranges::replace(place.words, '|', ' ');
  }
  return place;
}

void collect(const CommandWords& program, const std::string& above, std::vector<VerbWords>& list) {
  for (const CommandWords& verb : program.below) {
    VerbWords words{above + verb.name, verb.what, "", {}, {}};
    for (const CommandWords& below : verb.below) words.options += below.name + " ";
    for (const CommandWords::Value& value : verb.values) {
      if (value.argument) {
        words.alone = place_of(value);
        continue;
      }
      words.options += value.name + " ";
      if (value.takes_value) words.values.push_back(place_of(value));
    }
    list.push_back(words);
    collect(verb, words.name + " ", list);
  }
}

std::string keys() {
  std::string out;
  for (const auto& field : scene::scene_fields()) out += std::string(field.key) + "= ";
  return out;
}

/// Shell-specific code that completes words, keys and files.
struct Dialect {
  std::string words_before, words_after, keys, toml_files, folders, files;
};

std::string action(const Place& place, const Dialect& shell) {
  switch (place.expects) {
    case Expects::nothing:
      return "";
    case Expects::keys:
      return shell.keys;
    case Expects::toml_files:
      return shell.toml_files;
    case Expects::folders:
      return shell.folders;
    case Expects::files:
      return shell.files;
    case Expects::words:
      return shell.words_before + place.words + shell.words_after;
  }
  return "";
}

/// The case branches: "$verb $previous" for values of options, then "$verb".
std::string branches(const std::vector<VerbWords>& verbs, const Dialect& shell) {
  std::string out = "  case \"$verb $previous\" in\n";
  for (const VerbWords& verb : verbs) {
    for (const Place& place : verb.values) {
      const std::string what = action(place, shell);
      out += "    \"" + verb.name + " " + place.name + "\") " + (what.empty() ? "" : what + "; ") + "return ;;\n";
    }
  }
  out += "  esac\n  case \"$verb\" in\n";
  for (const VerbWords& verb : verbs) {
    const std::string what = action(verb.alone, shell);
    out += "    \"" + verb.name + "\")\n      if [[ $current == -* ]]; then " + shell.words_before + verb.options +
           shell.words_after + "; else " +
           (what.empty() ? shell.words_before + verb.options + shell.words_after : what) + "; fi ;;\n";
  }
  return out + "  esac\n";
}

/// "study|other": commands that have subcommands.
std::string nested(const std::vector<VerbWords>& verbs) {
  std::string out;
  for (const VerbWords& verb : verbs) {
    const std::size_t space = verb.name.find(' ');
    const std::string above = verb.name.substr(0, space);
    if (space != std::string::npos && ("|" + out + "|").find("|" + above + "|") == std::string::npos)
      out += (out.empty() ? "" : "|") + above;
  }
  return out.empty() ? "-" : out;
}

std::string bash_script(const std::string& program, const std::string& function, const std::vector<VerbWords>& verbs,
                        const std::string& first) {
  const Dialect shell{
      "COMPREPLY=($(compgen -W '",
      "' -- \"$current\"))",
      "COMPREPLY=($(compgen -W '" + keys() + "' -- \"$current\")); compopt -o nospace 2>/dev/null",
      "compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -X '!*.toml' -- \"$current\") $(compgen "
      "-d -- \"$current\"))",
      "compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -d -- \"$current\"))",
      "compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -- \"$current\"))"};
  return "# " + program + " completion for bash. To use it: source <(" + program + " completion bash)\n" + function +
         "() {\n"
         "  local IFS=$' \\t\\n' current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  local verb=\"${COMP_WORDS[1]}\"\n"
         "  COMPREPLY=()\n"
         "  # --option=value comes as three words.\n"
         "  if [[ $current == \"=\" ]]; then current=\"\"; elif [[ $previous == \"=\" ]]; then "
         "previous=\"${COMP_WORDS[COMP_CWORD-2]}\"; fi\n"
         "  if ((COMP_CWORD == 1)); then\n    " +
         shell.words_before + first + shell.words_after +
         "\n    return\n  fi\n"
         "  case \"$verb\" in\n    " +
         nested(verbs) + ") if ((COMP_CWORD > 2)); then verb=\"$verb ${COMP_WORDS[2]}\"; fi ;;\n  esac\n" +
         branches(verbs, shell) + "}\ncomplete -F " + function + " " + program + "\n";
}

std::string zsh_script(const std::string& program, const std::string& function, const std::vector<VerbWords>& verbs,
                       const std::string& first) {
  const Dialect shell{"compadd -- ", "", "compadd -S '' -- " + keys(), "_files -g '*.toml'", "_files -/", "_files"};
  return "#compdef " + program + "\n# " + program + " completion for zsh. To use it: source <(" + program +
         " completion zsh), after compinit\n" + function +
         "() {\n"
         "  local current=\"${words[CURRENT]}\" previous=\"${words[CURRENT-1]}\" verb=\"${words[2]}\"\n"
         "  if ((CURRENT == 2)); then\n    compadd -- " +
         first +
         "\n    return\n  fi\n"
         "  case \"$verb\" in\n    " +
         nested(verbs) + ") if ((CURRENT > 3)); then verb=\"$verb ${words[3]}\"; fi ;;\n  esac\n" +
         branches(verbs, shell) + "}\nif [[ \"${funcstack[1]}\" == " + function + " ]]; then " + function +
         "; else compdef " + function + " " + program + "; fi\n";
}

}  // namespace

std::string completion_script(const CommandWords& program, const std::string& shell) {
  std::vector<VerbWords> verbs;
  collect(program, "", verbs);
  std::string first;
  for (const VerbWords& verb : verbs) {
    if (verb.name.find(' ') == std::string::npos) first += verb.name + " ";
  }
  first += "--help --version";
  std::string function = "_" + program.name;
  std::ranges::replace(function, '-', '_');
  return shell == "zsh" ? zsh_script(program.name, function, verbs, first)
                        : bash_script(program.name, function, verbs, first);
}

void add_completion_verb(Program& program, std::string& shell) {
  Command verb = program.add("completion", "print a script that completes commands, options and files in a shell");
  verb.option("SHELL", shell, "bash or zsh").required().one_of({"bash", "zsh"});
  verb.footer("Example:\n  source <(" + program.program_name() + " completion bash)");
  verb.action([&program, &shell] {
    std::cout << completion_script(program.words(), shell);
    return done;
  });
}

}  // namespace touchstone::fast
