// SPDX-License-Identifier: BSD-3-Clause
// Version of the library, read by its CMakeLists.txt from here. C++17.
#pragma once

#define RIO_VERSION_MAJOR 0
#define RIO_VERSION_MINOR 1
#define RIO_VERSION_PATCH 0

/// One number to compare: 10203 is 1.2.3.
#define RIO_VERSION_NUMBER (10000 * RIO_VERSION_MAJOR + 100 * RIO_VERSION_MINOR + RIO_VERSION_PATCH)
