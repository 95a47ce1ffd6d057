// SPDX-License-Identifier: BSD-3-Clause
// RIO_ASSERT: programmer errors, checked unless NDEBUG is defined; replaceable handler. C++17.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace rio {

using AssertHandler = void (*)(const char* condition, const char* file, int line);

/// What a failed RIO_ASSERT calls. Tests replace it; the default prints and aborts.
inline AssertHandler& assert_handler() {
  static AssertHandler handler = [](const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: RIO_ASSERT(%s) failed\n", file, line, condition);
    std::abort();
  };
  return handler;
}

}  // namespace rio

#ifdef NDEBUG
#define RIO_ASSERT(condition) static_cast<void>(0)
#else
#define RIO_ASSERT(condition) \
  static_cast<void>((condition) || (::rio::assert_handler()(#condition, __FILE__, __LINE__), true))
#endif
