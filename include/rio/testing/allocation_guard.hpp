// SPDX-License-Identifier: BSD-3-Clause
// Counts heap allocations, including those of Eigen: link rio::testing.
#pragma once

// A sanitizer replaces malloc: g++ indicates it by macros, clang by features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIO_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RIO_COUNTS_ALLOCATIONS 0
#endif
#endif
#ifndef RIO_COUNTS_ALLOCATIONS
#define RIO_COUNTS_ALLOCATIONS 1
#endif

namespace rio::test {

/// Allocations by this thread since construction.
class AllocationGuard {
 public:
  static constexpr bool kWorks = RIO_COUNTS_ALLOCATIONS != 0;

  AllocationGuard() : begin_(total()) {}
  long count() const { return total() - begin_; }

 private:
  static long total();
  long begin_;
};

}  // namespace rio::test
