// What this binary was built from.
#pragma once

namespace touchstone::scene {

struct BuildInfo {
  const char* version;  ///< of Touchstone
  const char* commit;   ///< git, "-dirty" when the tree had changes
  const char* compiler;
  const char* build_type;
};
extern const BuildInfo build_info;

}  // namespace touchstone::scene
