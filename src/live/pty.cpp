// SPDX-License-Identifier: BSD-3-Clause
#include "live/pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "live/port.hpp"

namespace rio::live {

namespace fs = std::filesystem;

/// The other end is set to raw mode and closed again: from then on poll(2) reports whether it is
/// open.
Pty::Pty(fs::path link) : fd_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)), link_(std::move(link)) {
  const char* name = nullptr;
  if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || (name = ptsname(fd_)) == nullptr ||
      fcntl(fd_, F_SETFL, O_NONBLOCK) != 0) {
    throw std::runtime_error(std::string("no pseudo-terminal: ") + std::strerror(errno));
  }
  path_ = name;
  const int other = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  const bool raw = other >= 0 && make_raw(other, 921600);
  close(other);
  if (!raw) throw std::runtime_error(path_ + ": " + std::strerror(errno));
  if (link_.empty()) return;
  if (fs::is_symlink(link_)) fs::remove(link_);
  fs::create_directories(link_.parent_path());
  fs::create_symlink(path_, link_);
}

Pty::Pty(Pty&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      link_(std::exchange(other.link_, {})) {}

Pty::~Pty() {
  if (fd_ >= 0) close(fd_);
  std::error_code ignored;
  if (!link_.empty()) fs::remove(link_, ignored);
}

bool Pty::is_open() const {
  pollfd ask{fd_, 0, 0};
  return poll(&ask, 1, 0) == 0;
}

bool Pty::write(const std::uint8_t* bytes, std::size_t count) {
  constexpr int kPatience = 5000;  // [ms]
  while (count > 0) {
    pollfd ask{fd_, POLLOUT, 0};
    if (poll(&ask, 1, kPatience) != 1 || (ask.revents & POLLHUP) != 0) return false;
    const ssize_t written = ::write(fd_, bytes, count);
    if (written < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (written <= 0) continue;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

std::size_t Pty::read(std::uint8_t* buffer, std::size_t size) {
  const ssize_t count = ::read(fd_, buffer, size);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace rio::live
