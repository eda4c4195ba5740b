#include "support/no_heap.h"

#include <execinfo.h>
#include <unistd.h>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>

extern "C" {
// The C library's own heap functions, by their internal names.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {

thread_local bool armed = false;

void check(const char* call) noexcept {
  if (!armed) return;
  armed = false;  // the message below may allocate
  const char text[] = "heap use below step(): ";
  const auto say = [](const char* words, std::size_t length) {
    [[maybe_unused]] const auto n = write(STDERR_FILENO, words, length);
  };
  say(text, sizeof text - 1);
  say(call, std::strlen(call));
  say("\n", 1);
  void* frames[32];
  backtrace_symbols_fd(frames, backtrace(frames, 32), STDERR_FILENO);
  std::abort();
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  check("malloc");
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  check("calloc");
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  check("realloc");
  return __libc_realloc(old, size);
}
void free(void* old) {
  check("free");
  __libc_free(old);
}
void* memalign(std::size_t alignment, std::size_t size) {
  check("memalign");
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  check("aligned_alloc");
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  check("posix_memalign");
  void* block = __libc_memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *out = block;
  return 0;
}
void* valloc(std::size_t size) {
  check("valloc");
  return __libc_memalign(static_cast<std::size_t>(sysconf(_SC_PAGESIZE)), size);
}
void* pvalloc(std::size_t size) {
  check("pvalloc");
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return __libc_memalign(page, (size + page - 1) / page * page);
}

}  // extern "C"

namespace touchstone::test {

NoHeap::NoHeap() noexcept { armed = true; }
NoHeap::~NoHeap() { armed = false; }

}  // namespace touchstone::test
