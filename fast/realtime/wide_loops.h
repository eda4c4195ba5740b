// How functions with long loops are compiled.
#pragma once

#include "scene/base/inline.h"

/// Compiles a function with loops over vertices for 128 and for 256 bit registers and picks one at load. Neither has
/// fused multiplication, so both give the same bits. The picking runs before a sanitizer is ready, hence not there.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TOUCHSTONE_WIDE_LOOPS [[gnu::target_clones("default", "avx2")]]
#else
#define TOUCHSTONE_WIDE_LOOPS
#endif
