# Run at every build: writes build_info.cc when the version, commit or compiler changed.
execute_process(COMMAND git describe --always --dirty --abbrev=12 WORKING_DIRECTORY ${SOURCE_DIR}
  OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT COMMIT)
  set(COMMIT "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [=[
#include "scene/base/build_info.h"
namespace touchstone::scene {
const BuildInfo build_info = {"@VERSION@", "@COMMIT@", "@COMPILER@", "@BUILD_TYPE@"};
}
]=])
