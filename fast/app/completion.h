// Shell completion of commands, options, files and scene keys, from the declaration of the command line.
#pragma once

#include "fast/command/command.h"

#include <string>

namespace touchstone::fast {

/// A script to source. @param shell  "bash" or "zsh"
[[nodiscard]] std::string completion_script(const CommandWords& program, const std::string& shell);

/// Adds the command that prints it, after all other commands.
void add_completion_verb(Program& program, std::string& shell);

}  // namespace touchstone::fast
