// SPDX-License-Identifier: BSD-3-Clause
// Without a heap: who links rio::static_memory has malloc and operator new that take from one
// buffer of the caller and give nothing back. The estimator allocates in create() alone.
//
//   alignas(64) static unsigned char memory[1500 << 10];
//   rio::static_memory::give(memory, sizeof memory);
//   auto odometry = rio::Odometry::create(options, &why);
//   std::printf("%zu\n", rio::static_memory::used());  // what these options need
#pragma once

#include <cstddef>

namespace rio::static_memory {

/// From now on memory comes from this buffer, zero at first, which outlives the program's use of
/// it. Before, and beyond its end, malloc returns null: without exceptions the program aborts.
/// Not for several threads that allocate at a time.
void give(void* buffer, std::size_t size) noexcept;

/// Bytes taken of the buffer. They depend on the options and the target alone.
std::size_t used() noexcept;

}  // namespace rio::static_memory
