#include "compare/view/virtual_display.h"

#include "scene/base/error.h"

#include <X11/Xlib.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace touchstone::compare {

bool has_display() {
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return false;
  XCloseDisplay(display);
  return true;
}

VirtualDisplay::VirtualDisplay() {
  int ends[2];
  if (pipe(ends) != 0) throw scene::InputError("no pipe to Xvfb could be opened");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const std::string descriptor = std::to_string(ends[1]);
  const char* arguments[] = {"Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1920x1200x24", "-nolisten",
                             "tcp",  nullptr};
  const int failure =
      posix_spawnp(&process_, arguments[0], &actions, nullptr, const_cast<char* const*>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  // Xvfb writes its display number when it is ready; nothing if it ends before.
  std::string number;
  char digit = 0;
  while (failure == 0 && read(ends[0], &digit, 1) == 1 && digit != '\n') number += digit;
  close(ends[0]);
  if (!number.empty()) {
    setenv("DISPLAY", (":" + number).c_str(), 1);
    return;
  }
  if (failure == 0) waitpid(process_, nullptr, 0);
  throw scene::InputError("no display, and Xvfb, which would replace one, " +
                          std::string(failure != 0 ? "is missing: apt-get install xvfb" : "did not start"));
}

VirtualDisplay::~VirtualDisplay() {
  unsetenv("DISPLAY");
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
}

}  // namespace touchstone::compare
