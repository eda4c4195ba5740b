// Which models there are.
#pragma once

#include "compare/model/request.h"

#include <vector>

namespace touchstone::compare {

/// Every kind, in the order in which tables list them. A new kind is a line here.
[[nodiscard]] const std::vector<ModelList>& registered_models();

}  // namespace touchstone::compare
