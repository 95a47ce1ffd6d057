// SPDX-License-Identifier: BSD-3-Clause
#include "rio/testing/allocation_guard.hpp"

#include <cerrno>
#include <cstddef>

namespace {
thread_local long allocations = 0;
}

namespace rio::test {
long AllocationGuard::total() {
  return allocations;
}
}  // namespace rio::test

#if RIO_COUNTS_ALLOCATIONS
// Counting replacements of malloc and its relatives; operator new and Eigen both end here. glibc
// provides the originals under these names.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* pointer, std::size_t size);           // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* pointer, std::size_t size) {
  ++allocations;
  return __libc_realloc(pointer, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) {
  ++allocations;
  *pointer = __libc_memalign(alignment, size);
  return *pointer == nullptr ? ENOMEM : 0;
}
}
#endif
