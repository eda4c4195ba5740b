// The command line's declaration: a program, its commands and their options. The only user of CLI11, which
// takes ten seconds to compile.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace touchstone::fast {

/// An option or argument of a command. Every call refines it and returns it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option required() const;
  Option range(int least, int largest) const;
  Option range(double least, double largest) const;
  Option positive() const;
  Option one_of(std::vector<std::string> words) const;
  Option values(int count) const;               ///< takes so many words
  Option one_value_each_time() const;           ///< "--set A --set B", never "--set A B"
  Option type(const std::string& shown) const;  ///< what the help shows for its value
  Option shows_default() const;                 ///< the value that the variable has now, in the help
  Option needs(const Option& other) const;
  Option excludes(const Option& other) const;

 private:
  CLI::Option* option_;
};

/// What the declaration says of a command, for completion in a shell.
struct CommandWords {
  struct Value {
    std::string name;  ///< "--out"; of an argument "SCENE"
    std::string type;  ///< as the help shows it, "TEXT"
    bool argument = false;
    bool takes_value = true;
  };
  std::string name, what;
  std::vector<Value> values;
  std::vector<CommandWords> below;
};

/// A command of a program, or the program itself. Variables that it is given must outlive Program::run.
class Command {
 public:
  /// A command below this one; one of them must then be chosen.
  Command add(const std::string& name, const std::string& what);
  /// "--name" or, as an argument, "NAME". T: a path, string, int, double, 64-bit integer, an optional number, or a
  /// vector of paths or strings.
  template <class T>
  Option option(const std::string& name, T& value, const std::string& what);
  /// @param take  uses the word; returns what is wrong with it, or nothing
  Option option(const std::string& name, std::function<std::string(const std::string&)> take, const std::string& what);
  Option flag(const std::string& name, bool& value, const std::string& what);
  /// A flag that prints a text and ends the program.
  void prints(const std::string& flag, std::function<std::string()> text, const std::string& what);
  /// Shown below the options. @param call  what follows the program's name
  void example(const std::string& call);
  void footer(const std::string& text);
  /// Runs when the command is chosen. @param action  returns the exit code
  void action(std::function<int()> action);
  /// The program's name.
  [[nodiscard]] std::string program_name() const;

 protected:
  Command(CLI::App* app, CLI::App* root, int* exit_code) : app_(app), root_(root), exit_code_(exit_code) {}
  CLI::App* app_;
  CLI::App* root_;
  int* exit_code_;
};

class Program : public Command {
 public:
  Program(const std::string& what, const std::string& name);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// The commands of --help under headings, in this order; the rest under "More".
  void group(const std::vector<std::pair<std::string, std::vector<std::string>>>& groups);
  [[nodiscard]] CommandWords words() const;
  /// Parses and runs the chosen command; a command line that is wrong is one message on stderr and an exit code. A
  /// program with commands prints its help when there is no argument.
  /// @returns the action's exit code, or of a program without one `done`
  /// @throws what the action throws
  [[nodiscard]] int run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> owned_;
  int code_ = 0;
};

}  // namespace touchstone::fast
