// How the real-time code treats numbers too small for full precision.
#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace touchstone::fast {

/// Sets numbers too small for full precision to zero while it exists: they cost a hundred times a normal one, and a
/// surface at rest in some direction is full of them.
class FlushTinyNumbers {
 public:
#if defined(__SSE__)
  FlushTinyNumbers() noexcept : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushTinyNumbers() { _mm_setcsr(before_); }
  FlushTinyNumbers(const FlushTinyNumbers&) = delete;
  FlushTinyNumbers& operator=(const FlushTinyNumbers&) = delete;

 private:
  unsigned before_;
#endif
};

}  // namespace touchstone::fast
