// Proof that a stretch of code does not touch the heap. Linking no_heap.cc puts this binary's own malloc family before
// the C library's, for every library in the process: Eigen calls malloc and not operator new, which itself ends there.
#pragma once

namespace touchstone::test {

/// While one lives on this thread, any malloc, calloc, realloc, free, posix_memalign, aligned_alloc, memalign, valloc
/// or pvalloc on it ends the process with "heap use below step()".
class NoHeap {
 public:
  NoHeap() noexcept;
  ~NoHeap();
  NoHeap(const NoHeap&) = delete;
  NoHeap& operator=(const NoHeap&) = delete;
};

}  // namespace touchstone::test
