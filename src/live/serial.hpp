// SPDX-License-Identifier: BSD-3-Clause
// Terminal lines as transparent byte channels. Linux: termios2, for any baud rate.
#pragma once

namespace rio::live {

inline constexpr double kBitsPerByte = 10.0;  ///< on the wire, 8N1

/// Raw bytes both ways, 8N1, no flow control, no echo. Pending input is discarded, since its
/// arrival time is unknown. Does nothing if it is not a terminal.
/// @param baud any rate, 1200 to 1e8
/// @return false, with errno set, if the line refuses it or cannot come near the rate
bool make_raw(int fd, int baud);

/// Whether it is a rate for make_raw().
bool is_baud(int baud);

}  // namespace rio::live
