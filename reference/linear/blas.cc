#include "reference/linear/blas.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <vector>

namespace touchstone::reference {
namespace {

template <class Function>
Function* loaded_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

/// Memory that OpenBLAS maps per thread, with a margin. OpenBLAS does not give up if it cannot map it.
constexpr std::size_t bytes_per_thread = std::size_t{129} << 20;

bool can_be_mapped(int threads) {
  std::vector<void*> maps;
  while (std::ssize(maps) < threads) {
    void* map = ::mmap(nullptr, bytes_per_thread, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED) break;
    maps.push_back(map);
  }
  for (void* map : maps) ::munmap(map, bytes_per_thread);
  return std::ssize(maps) == threads;
}

int blas_threads() {
  auto* threads = loaded_function<int()>("openblas_get_num_threads");
  return threads ? threads() : 1;
}

/// A call that makes OpenBLAS map the calling thread's memory, which it keeps.
void take_memory() {
  auto* factorise =
      loaded_function<void(const char*, const std::int64_t*, double*, const std::int64_t*, std::int64_t*)>("dpotrf_");
  const std::int64_t one = 1;
  double value = 1.0;
  std::int64_t info = 0;
  if (factorise) factorise("L", &one, &value, &one, &info);
}

}  // namespace

bool blas_has_memory() { return can_be_mapped(blas_threads() - 1); }

void set_blas_threads(int threads) {
  auto* set_threads = loaded_function<void(int)>("openblas_set_num_threads");
  if (!set_threads) return;
  static int with_memory = 0;
  if (threads > with_memory && !can_be_mapped(std::max(threads, blas_threads()))) throw std::bad_alloc();
  set_threads(threads);
  if (threads > with_memory) take_memory();
  with_memory = std::max(with_memory, threads);
}

std::string blas_description(int threads) {
  auto* config = loaded_function<char*()>("openblas_get_config");
  if (!config) return "a BLAS that is not OpenBLAS";
  return config() + std::string(", ") + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

}  // namespace touchstone::reference
