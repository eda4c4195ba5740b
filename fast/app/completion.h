// Shell completion of verbs, options, files and scene keys, read off the command line's own declaration.
#pragma once

#include "fast/command/command.h"

#include <string>

namespace touchstone::fast {

/// A script to source. @param shell  "bash" or "zsh"
[[nodiscard]] std::string completion_script(const CommandWords& program, const std::string& shell);

/// Adds the verb that prints it. To be added last, when all verbs are there, though the script is written when it runs.
void add_completion_verb(Program& program, std::string& shell);

}  // namespace touchstone::fast
