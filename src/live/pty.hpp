// SPDX-License-Identifier: BSD-3-Clause
// A pseudo-terminal: a serial line without a cable. The side of the device is here, the other end
// has a path that any program opens as it would /dev/ttyACM1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace rio::live {

class Pty {
 public:
  /// Throws std::runtime_error if there is none to be had.
  /// @param link if given, a link to the other end, in place of an older link; removed at the end
  explicit Pty(std::filesystem::path link = {});
  ~Pty();
  Pty(Pty&& other) noexcept;
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
  Pty& operator=(Pty&&) = delete;

  const std::string& path() const { return path_; }
  int fd() const { return fd_; }

  /// Some program has the other end open.
  bool is_open() const;
  /// Waits for room where the reader is slow.
  /// @return false if the other end was closed meanwhile, or has no room for five seconds
  bool write(const std::uint8_t* bytes, std::size_t count);
  /// What the other end has written; 0 if nothing.
  std::size_t read(std::uint8_t* buffer, std::size_t size);

 private:
  int fd_ = -1;
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace rio::live
