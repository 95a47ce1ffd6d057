// SPDX-License-Identifier: BSD-3-Clause
#include "live/serial.hpp"

#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>

namespace rio::live {
namespace {

struct Baud {
  int baud;
  speed_t code;
};
constexpr Baud kBauds[] = {{1200, B1200},       {2400, B2400},       {4800, B4800},
                           {9600, B9600},       {19200, B19200},     {38400, B38400},
                           {57600, B57600},     {115200, B115200},   {230400, B230400},
                           {460800, B460800},   {500000, B500000},   {576000, B576000},
                           {921600, B921600},   {1000000, B1000000}, {1152000, B1152000},
                           {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000},
                           {3000000, B3000000}, {3500000, B3500000}, {4000000, B4000000}};

const Baud* find(int baud) {
  const Baud* at = std::find_if(std::begin(kBauds), std::end(kBauds),
                                [baud](const Baud& known) { return known.baud == baud; });
  return at == std::end(kBauds) ? nullptr : at;
}

}  // namespace

bool is_baud(int baud) {
  return find(baud) != nullptr;
}

bool make_raw(int fd, int baud) {
  if (isatty(fd) == 0) return true;
  termios line{};
  const Baud* known = find(baud);
  if (known == nullptr || tcgetattr(fd, &line) != 0) return false;
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= static_cast<tcflag_t>(~(CSTOPB | CRTSCTS));
  line.c_cc[VMIN] = 0;
  line.c_cc[VTIME] = 0;
  return cfsetispeed(&line, known->code) == 0 && cfsetospeed(&line, known->code) == 0 &&
         tcsetattr(fd, TCSANOW, &line) == 0 && tcflush(fd, TCIFLUSH) == 0;
}

}  // namespace rio::live
