#include "fast/bench/floor.h"

#include <cstring>

namespace touchstone::bench {
namespace {

/// A compiler barrier: the memory behind the pointer may be read and written here.
void seen(const void* memory) noexcept { asm volatile("" : : "r"(memory) : "memory"); }

void copy_columns(const fast::Columns3& from, fast::Columns3& to) noexcept {
  for (std::size_t axis = 0; axis < from.size(); ++axis) {
    seen(from[axis].data());
    std::memcpy(to[axis].data(), from[axis].data(), from[axis].size() * sizeof(float));
    seen(to[axis].data());
  }
}

}  // namespace

CopyFloor::CopyFloor(const fast::SurfaceField& at_rest) : from_(at_rest), to_(at_rest) {
  for (auto& column : to_.normal) std::fill(column.begin(), column.end(), 0.0f);
  // Not the zero displacements at rest, whose pages may share one zero page of memory.
  for (auto& column : from_.displacement_m) std::fill(column.begin(), column.end(), 1e-3f);
}

void CopyFloor::copy() noexcept {
  copy_columns(from_.displacement_m, to_.displacement_m);
  copy_columns(from_.normal, to_.normal);
}

}  // namespace touchstone::bench
