// The BLAS that this process uses. It is chosen when the process starts, so the loaded library is queried.
#pragma once

#include <string>

namespace touchstone::reference {

/// Whether the threads that OpenBLAS starts with the process have the memory that each takes. Where one cannot have it,
/// it tries again without end, and so does the process that waits for it when it ends. True with another BLAS.
[[nodiscard]] bool blas_has_memory();

/// For the whole process. Does nothing with a BLAS that is not OpenBLAS.
/// @throws std::bad_alloc where the threads, the calling one with them, cannot have the memory that each takes
void set_blas_threads(int threads);

/// "OpenBLAS 0.3.21 ..., 2 threads"
[[nodiscard]] std::string blas_description(int threads);

}  // namespace touchstone::reference
