// Shows that a section of code does not use the heap. Linking no_heap.cc replaces malloc and its relatives for every
// library in the process: Eigen calls malloc and not operator new, which itself calls malloc.
#pragma once

namespace touchstone::test {

/// While such an object exists on this thread, any malloc, calloc, realloc, free, posix_memalign, aligned_alloc,
/// memalign, valloc or pvalloc on it ends the process with "heap use below step()".
class NoHeap {
 public:
  NoHeap() noexcept;
  ~NoHeap();
  NoHeap(const NoHeap&) = delete;
  NoHeap& operator=(const NoHeap&) = delete;
};

}  // namespace touchstone::test
