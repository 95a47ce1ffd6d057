// SPDX-License-Identifier: BSD-3-Clause
#include "live/serial.hpp"

#include <asm/termbits.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace rio::live {
namespace {

constexpr int kSlowest = 1200;
constexpr int kFastest = 100000000;
constexpr int kNear = 50;  // a UART bears a difference of 1 in so many

}  // namespace

bool is_baud(int baud) {
  return baud >= kSlowest && baud <= kFastest;
}

bool make_raw(int fd, int baud) {
  if (isatty(fd) == 0) return true;
  termios2 line{};
  if (ioctl(fd, TCGETS2, &line) != 0) return false;
  line.c_iflag = 0;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = BOTHER | CS8 | CLOCAL | CREAD;
  line.c_ispeed = line.c_ospeed = static_cast<speed_t>(baud);
  line.c_cc[VMIN] = 0;
  line.c_cc[VTIME] = 0;
  if (ioctl(fd, TCSETS2, &line) != 0 || ioctl(fd, TCGETS2, &line) != 0) return false;
  if (std::abs(static_cast<int>(line.c_ospeed) - baud) > baud / kNear) {  // the nearest it can do
    errno = EINVAL;
    return false;
  }
  return ioctl(fd, TCFLSH, TCIFLUSH) == 0;
}

}  // namespace rio::live
