#include "reference/linear/blas.h"

#include <dlfcn.h>

namespace touchstone::reference {
namespace {

template <class Function>
Function* loaded_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

void set_blas_threads(int threads) {
  if (auto* set_threads = loaded_function<void(int)>("openblas_set_num_threads")) set_threads(threads);
}

std::string blas_description(int threads) {
  auto* config = loaded_function<char*()>("openblas_get_config");
  if (!config) return "a BLAS that is not OpenBLAS";
  return config() + std::string(", ") + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

}  // namespace touchstone::reference
