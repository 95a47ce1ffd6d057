// SPDX-License-Identifier: BSD-3-Clause
// A pseudo-terminal: a serial line without a cable. This is the side of the device; the path of the
// other end can be opened like /dev/ttyACM1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace rio::live {

class Pty {
 public:
  /// Throws std::runtime_error if none is available.
  /// @param link if given, a link to the other end, which replaces an older link; removed at the
  /// end
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
  /// Waits for space if the reader is slow.
  /// @return false if the other end was closed meanwhile, or has no space for five seconds
  bool write(const std::uint8_t* bytes, std::size_t count);
  /// Bytes written by the other end; 0 if none.
  std::size_t read(std::uint8_t* buffer, std::size_t size);

 private:
  int fd_ = -1;
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace rio::live
