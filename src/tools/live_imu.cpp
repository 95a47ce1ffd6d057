// SPDX-License-Identifier: BSD-3-Clause
#include "live_imu.hpp"

#include <fmt/format.h>

#include "check/imu_check.hpp"

namespace rio::tools {

void ImuPort::take(const std::uint8_t* bytes, std::size_t count, Time arrival,
                   const OnSample& on_sample) {
  if (first_samples_.empty()) others_.push(bytes, count, arrival, [](ti::Frame&) {});
  if (is_mavlink()) return;
  if (format_ == "csv") {
    lines_.push(bytes, count, on_sample);
  } else {
    frames_.push(bytes, count, on_sample);
  }
}

std::string ImuPort::wait(const ImuSample& sample) {
  constexpr std::size_t kMost = 10'000;  // five seconds at 2 kHz
  constexpr std::size_t kMany = 1'000;   // if their stamps are in another unit
  constexpr double kLong = 5.0;          // [s]
  if (first_samples_.size() >= kMost) return {};
  first_samples_.push_back(sample);
  const double waited = to_seconds(sample.time - first_samples_.front().time);
  if (told_ || (waited < kLong && first_samples_.size() < kMany)) return {};
  told_ = true;
  return "IMU: no start yet: " + why_no_start();
}

std::string ImuPort::why_no_sample(const std::string& messages) const {
  const ti::PacketCounters& seen = others_.counters();
  if (seen.frames + seen.other_sdk > 0) {
    return ", but packets of a TI radar: give the port of the IMU; --imu and --radar may be "
           "exchanged";
  }
  if (seen.bytes == 0) return ": no byte came";
  if (const std::uint64_t damaged = frames_.counters().damaged; damaged > 0) {
    return fmt::format(
        ", but {} whose checksum is wrong: bytes are missing, or the sender packs them otherwise",
        damaged);
  }
  const ti::OtherDevice* other = others_.other_device();
  const std::string advice = other == nullptr ? "" : other->at_imu;
  if (is_mavlink() && (!messages.empty() || advice.find("mavlink") != advice.npos)) {
    const bool raw = format_ == "mavlink-raw";
    return fmt::format(
        ", but MAVLink without a usable {} of IMU 0 (seen: {}): have it sent, or --imu-format {}",
        raw ? "RAW_IMU" : "HIGHRES_IMU", messages.empty() ? "none that is read" : messages,
        raw ? "mavlink" : "mavlink-raw");
  }
  if (other != nullptr) {
    return fmt::format(", but {}: {}", other->what, advice);
  }
  return fmt::format(" in {} bytes: another port, baud rate or --imu-format{}", seen.bytes,
                     format_ == "csv" ? ", or no lines of seven numbers with commas" : "");
}

std::string ImuPort::why_no_start() const {
  if (first_samples_.size() > 1) {
    const check::ImuCheck of_imu =
        check::check_imu(check::Usable(first_samples_), {}, check::Source::kFolder, {});
    for (const check::Finding& finding : of_imu.findings) {
      if (finding.verdict != check::Verdict::kWrong) continue;
      return fmt::format("{}: {}; --imu must send rad/s, m/s^2 with gravity, and ns",
                         finding.subject, finding.text);
    }
  }
  return "hold it still at first, or give start.max_wait";
}

}  // namespace rio::tools
