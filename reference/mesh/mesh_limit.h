// How many cells a mesh may have.
#pragma once

#include "scene/base/error.h"

namespace touchstone::reference {

inline constexpr int most_cells = 300'000;

/// A grading asks for more cells than any machine could solve.
class MeshTooLarge : public scene::InputError {
 public:
  using scene::InputError::InputError;
};

}  // namespace touchstone::reference
