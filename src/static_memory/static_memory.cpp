// SPDX-License-Identifier: BSD-3-Clause
#include "rio/static_memory.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace rio::static_memory {

namespace {

unsigned char* memory = nullptr;
std::size_t capacity = 0;
std::size_t taken = 0;

void* take(std::size_t size, std::size_t align) noexcept {
  const std::uintptr_t free_at = reinterpret_cast<std::uintptr_t>(memory) + taken;
  const std::size_t gap = (align - free_at % align) % align;
  if (gap > capacity - taken || size > capacity - taken - gap) return nullptr;
  unsigned char* const at = memory + taken + gap;
  taken += gap + size;
  return at;
}

}  // namespace

void give(void* buffer, std::size_t size) noexcept {
  memory = static_cast<unsigned char*>(buffer);
  capacity = size;
  taken = 0;
}

std::size_t used() noexcept {
  return taken;
}

}  // namespace rio::static_memory

// operator new and Eigen end here, too
extern "C" {
void* malloc(std::size_t size) {
  return rio::static_memory::take(size, alignof(std::max_align_t));
}
void* calloc(std::size_t count, std::size_t size) {  // the buffer is zero; no byte is given twice
  return size != 0 && count > SIZE_MAX / size ? nullptr : malloc(count * size);
}
void* realloc(void* from, std::size_t size) {
  void* const to = malloc(size);
  if (from != nullptr && to != nullptr) std::memmove(to, from, size);
  return to;
}
void free(void* /*pointer*/) {}
void* aligned_alloc(std::size_t align, std::size_t size) {
  return rio::static_memory::take(size, align);
}
int posix_memalign(void** to, std::size_t align, std::size_t size) {
  *to = rio::static_memory::take(size, align);
  return *to == nullptr ? ENOMEM : 0;
}
}
