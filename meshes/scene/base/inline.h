// Small functions that loops over columns of numbers take in.
#pragma once

/// Takes a function into the registers of the one that calls it.
#define TOUCHSTONE_INLINE [[gnu::always_inline]] inline
