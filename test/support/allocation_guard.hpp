// SPDX-License-Identifier: BSD-3-Clause
// Counts heap allocations, those of Eigen included: link test/support/allocation_guard.cpp.
#pragma once

namespace rio::test {

/// Allocations by this thread since construction.
class AllocationGuard {
 public:
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static constexpr bool kWorks = false;  // the sanitizer owns malloc
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  static constexpr bool kWorks = false;
#else
  static constexpr bool kWorks = true;
#endif
#else
  static constexpr bool kWorks = true;
#endif

  AllocationGuard() : begin_(total()) {}
  long count() const {
    return total() - begin_;
  }

 private:
  static long total();
  long begin_;
};

}  // namespace rio::test
