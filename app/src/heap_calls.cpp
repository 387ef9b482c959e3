// SPDX-License-Identifier: Apache-2.0
//
// Counts the heap calls of each thread, to name a plugin or a test that allocates in its step. The
// functions replace those of the C library and cost about a nanosecond. Sanitizers replace them,
// too, so heap calls are then not counted.
#include <cerrno>
#include <cstddef>

#ifndef RTHS_SANITIZED
namespace {
thread_local long calls = 0;
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

long rths_heap_calls();
long rths_heap_calls() { return calls; }

void* malloc(std::size_t size) {
  ++calls;
  return __libc_malloc(size);
}
void free(void* block) {
  ++calls;
  __libc_free(block);
}
void* calloc(std::size_t count, std::size_t size) {
  ++calls;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++calls;
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++calls;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++calls;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++calls;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}
#endif
