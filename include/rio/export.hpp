// SPDX-License-Identifier: BSD-3-Clause
// RIO_API marks the symbols that a shared library of the odometry API exports; all others are
// hidden. C++17.
#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define RIO_API __attribute__((visibility("default")))
#else
#define RIO_API
#endif
