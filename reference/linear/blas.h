// The BLAS this process runs on. It is chosen when the process starts, so it is asked of whatever is loaded.
#pragma once

#include <string>

namespace touchstone::reference {

/// For the whole process. Does nothing with a BLAS that is not OpenBLAS.
void set_blas_threads(int threads);

/// "OpenBLAS 0.3.21 ..., 2 threads"
[[nodiscard]] std::string blas_description(int threads);

}  // namespace touchstone::reference
