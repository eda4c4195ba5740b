// An X display: the one there is, or a virtual one while pictures are drawn.
#pragma once

#include <sys/types.h>

namespace touchstone::compare {

/// Can windows be opened here, on the display DISPLAY names?
[[nodiscard]] bool has_display();

/// Xvfb as a child process, and DISPLAY set to it; both end with the object.
class VirtualDisplay {
 public:
  /// @throws scene::InputError when Xvfb (Debian package xvfb) is missing or does not start
  VirtualDisplay();
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

 private:
  pid_t process_ = -1;
};

}  // namespace touchstone::compare
