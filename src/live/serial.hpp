// SPDX-License-Identifier: BSD-3-Clause
// Terminal lines as transparent byte channels (termios).
#pragma once

namespace rio::live {

/// Raw bytes both ways, 8N1, no flow control, no echo. Pending input is discarded, since its
/// arrival time is unknown. Does nothing if it is not a terminal.
/// @param baud a rate that termios supports, 1200 to 4000000
/// @return false, with errno set, if the line refuses it
bool make_raw(int fd, int baud);

/// Whether make_raw() supports it.
bool is_baud(int baud);

}  // namespace rio::live
