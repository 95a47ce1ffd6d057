// SPDX-License-Identifier: BSD-3-Clause
#include "live/port.hpp"

#include <arpa/inet.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace rio::live {
namespace {

constexpr int kLongestWait = 50;  // [ms]
constexpr Time kRetry = std::chrono::milliseconds(200);
constexpr double kForEver = 1e9;  // [s]
constexpr std::size_t kBuffer = 65536;
constexpr int kSlowest = 1200;
constexpr int kFastest = 100000000;
constexpr int kNear = 50;  // a UART bears a difference of 1 in so many

[[noreturn]] void fail(const std::string& name, const std::string& why) {
  throw std::runtime_error(name + ": " + why);
}
[[noreturn]] void fail_errno(const std::string& name) {
  fail(name, std::strerror(errno));
}

/// The whole text as a number; -1 if it is not one.
int number(const std::string& text) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : -1;
}

/// "PORT" or "ADDRESS:PORT".
sockaddr_in address_of(const std::string& name, const std::string& text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const std::size_t colon = text.rfind(':');
  const std::string host = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const int port = number(colon == std::string::npos ? text : text.substr(colon + 1));
  if (port < 1 || port > 65535 || inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    fail(name, "must be udp:PORT or udp:ADDRESS:PORT, the address in numbers");
  }
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

bool is_gone(int error) {
  return error == ENOENT || error == ENXIO || error == ENODEV || error == EIO;
}

}  // namespace

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

Port::Port(const std::string& name, int default_baud)
    : name_(name), path_(name), baud_(default_baud) {
  if (name.rfind("udp:", 0) == 0) {
    is_udp_ = true;
    peer_ = address_of(name, name.substr(4));
    listens_ = name.find(':', 4) == std::string::npos;
    return;
  }
  if (const std::size_t at = name.rfind('@'); at != std::string::npos) {
    baud_ = number(name.substr(at + 1));
    path_ = name.substr(0, at);
  }
  if (path_.empty()) fail(name, "is no port");
  if (baud_ < kSlowest || baud_ > kFastest) fail(name, "no such baud rate");
}

Port::Port(Port&& other) noexcept
    : name_(std::move(other.name_)),
      path_(std::move(other.path_)),
      baud_(other.baud_),
      is_udp_(other.is_udp_),
      listens_(other.listens_),
      peer_(other.peer_),
      fd_(std::exchange(other.fd_, -1)),
      is_line_(other.is_line_),
      state_(other.state_) {}

bool Port::open() {
  if (fd_ >= 0) return true;
  is_udp_ ? open_udp() : open_path();
  if (fd_ >= 0) state_ = State::kOpen;
  return fd_ >= 0;
}

void Port::open_path() {
  if (path_ == "-") {
    fd_ = dup(STDIN_FILENO);
    if (fd_ < 0) fail_errno(name_);
    return;
  }
  struct stat status {};
  const bool exists = stat(path_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) fail(name_, "is a folder: give a port or a file in it");
  const bool is_device = exists && S_ISCHR(status.st_mode);
  fd_ = ::open(path_.c_str(), (is_device ? O_RDWR : O_RDONLY) | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0 && is_gone(errno)) return;
  if (fd_ < 0) fail_errno(name_);
  is_line_ = isatty(fd_) != 0;
  if (is_line_) (void)ioctl(fd_, TIOCEXCL);  // two readers would share the bytes
  if (make_raw(fd_, baud_)) return;
  const int error = errno;
  close();
  if (!is_gone(error)) fail(name_, std::strerror(error));
}

void Port::open_udp() {
  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) fail_errno(name_);
  const auto* address = reinterpret_cast<const sockaddr*>(&peer_);
  if (listens_ && bind(fd_, address, sizeof peer_) != 0) fail_errno(name_);
  if (!listens_ && connect(fd_, address, sizeof peer_) != 0) fail_errno(name_);
}

void Port::close() {
  if (fd_ >= 0 && is_line_) (void)ioctl(fd_, TIOCNXCL);  // a pseudo-terminal would keep it
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

std::size_t Port::read(std::uint8_t* buffer, std::size_t size) {
  if (fd_ < 0) return 0;
  sockaddr_in from{};
  socklen_t length = sizeof from;
  const ssize_t count =
      listens_ ? recvfrom(fd_, buffer, size, 0, reinterpret_cast<sockaddr*>(&from), &length)
               : ::read(fd_, buffer, size);
  if (count > 0) {
    if (listens_) peer_ = from;
    return static_cast<std::size_t>(count);
  }
  // no UDP receiver (yet): the next datagram may find one
  const bool nothing_now =
      count < 0 && (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED);
  if (nothing_now || is_udp_) return 0;
  close();
  state_ = is_line_ ? State::kVanished : State::kEnded;
  return 0;
}

bool Port::write(const std::uint8_t* bytes, std::size_t count) {
  if (fd_ < 0) return false;
  const ssize_t written = listens_ ? sendto(fd_, bytes, count, 0,
                                            reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_)
                                   : ::write(fd_, bytes, count);
  return written == static_cast<ssize_t>(count);
}

PortSet::PortSet(const HostClock& clock, double patience, OnMessage on_message)
    : clock_(clock),
      patience_(from_seconds(std::min(patience, kForEver))),
      on_message_(std::move(on_message)),
      buffer_(kBuffer) {}

Port& PortSet::add(Watched watched) {
  for (const Entry& entry : entries_) {
    const std::string& other = entry.watched.port.name();
    if (std::filesystem::weakly_canonical(other) !=
        std::filesystem::weakly_canonical(watched.port.name())) {
      continue;
    }
    throw std::runtime_error(other + ": given for two, " + entry.watched.what + " and " +
                             watched.what);
  }
  entries_.push_back({std::move(watched)});
  entries_.back().since = HostClock::real();
  return entries_.back().watched.port;
}

bool PortSet::wait() {
  std::vector<pollfd> asked;
  for (Entry& entry : entries_) {
    if (!entry.over && entry.watched.port.fd() < 0) reopen(&entry);
    asked.push_back({entry.watched.port.fd(), POLLIN, 0});  // poll ignores negative descriptors
  }
  const int ready = poll(asked.data(), asked.size(), kLongestWait);
  for (std::size_t i = 0; ready > 0 && i < asked.size(); ++i) {
    if (asked[i].revents != 0) read(&entries_[i]);
  }
  return std::any_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return entry.watched.needed && !entry.over; });
}

void PortSet::close() {
  for (Entry& entry : entries_) entry.watched.port.close();
}

void PortSet::reopen(Entry* entry) {
  const Time now = HostClock::real();
  if (now < entry->next_try) return;
  entry->next_try = now + kRetry;
  Watched& watched = entry->watched;
  if (watched.port.open()) {
    if (entry->was_open) {
      on_message_(watched.what + ": " + watched.port.name() + " is back");
      watched.on_reopened();
    }
    entry->was_open = true;
  } else if (now - entry->since >= patience_) {
    entry->over = true;
    on_message_(watched.what + ": " + watched.port.name() + " is not there");
  } else if (!entry->was_open && !std::exchange(entry->awaited, true)) {
    on_message_(watched.what + ": " + watched.port.name() + " is not there yet: it is waited for");
  }
}

void PortSet::read(Entry* entry) {
  Watched& watched = entry->watched;
  const std::size_t count = watched.port.read(buffer_.data(), buffer_.size());
  if (count > 0) watched.on_bytes(buffer_.data(), count, clock_.now());
  if (watched.port.state() == Port::State::kOpen) return;
  entry->over = watched.port.state() == Port::State::kEnded;
  entry->since = HostClock::real();
  entry->next_try = entry->since + std::min(kRetry, patience_);
  on_message_(watched.what + ": " + watched.port.name() +
              (entry->over ? " has ended" : " vanished"));
}

}  // namespace rio::live
