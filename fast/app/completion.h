// Shell completion of verbs, options, files and scene keys, read off the command line's own declaration.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace touchstone::fast {

/// A script to source. @param shell  "bash" or "zsh"
[[nodiscard]] std::string completion_script(const CLI::App& app, const std::string& shell);

/// Adds the verb that prints it. To be added last, when all verbs are there, though the script is written when it runs.
CLI::App* add_completion_verb(CLI::App& app, std::string& shell, int& exit_code);

}  // namespace touchstone::fast
