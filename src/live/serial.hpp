// SPDX-License-Identifier: BSD-3-Clause
// Terminal lines as plain wires for bytes (termios).
#pragma once

namespace rio::live {

/// Bytes pass unchanged both ways, 8N1, no flow control, no echo; what has piled up is thrown away,
/// nobody knows when it came. Not a terminal: nothing to do.
/// @param baud one of those that termios knows, 1200 to 4000000
/// @return false, and errno set, if the line does not take it
bool make_raw(int fd, int baud);

/// Whether make_raw() knows it.
bool is_baud(int baud);

}  // namespace rio::live
