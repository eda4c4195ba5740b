#include "support/source_folder.h"

namespace touchstone {

std::string source_folder() { return TOUCHSTONE_SOURCE_DIR; }

}  // namespace touchstone
