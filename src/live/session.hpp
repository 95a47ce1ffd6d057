// SPDX-License-Identifier: BSD-3-Clause
// Bytes of radars and samples of an IMU, as they arrive -> estimates. Independent of ports and
// clocks: every arrival time is an argument.
//
// The estimator uses the clock of the IMU. A radar frame is stamped in the clock of the arrivals
// (ti/frame_clock.hpp) and converted to that of the IMU with the offset from the arrivals of the
// samples (host_clock.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/host_clock.hpp"
#include "rio/rio.hpp"
#include "rio/ti/frame_clock.hpp"
#include "rio/ti/packet_reader.hpp"

namespace rio::live {

class Session;

/// Interface for the events of a session. One that throws is called no more: a full disk ends no
/// flight.
class Listener {
 public:
  virtual ~Listener() = default;
  /// The estimator has accepted or refused a sample.
  virtual void on_imu(const Session& /*session*/, const ImuSample& /*sample*/) {}
  /// The same of a scan, in the clock of the IMU.
  virtual void on_scan(const Session& /*session*/, const RadarScan& /*scan*/,
                       std::size_t /*radar*/) {}
  /// A scan was processed; the estimate is odometry().at_scan().
  /// @param arrival of the last byte of that scan
  virtual void on_estimate(const Session& /*session*/, Time /*arrival*/) {}
  /// No event will come any more.
  virtual void on_end() {}
};

/// Of one radar; a frame may be left out for several reasons.
struct FrameCounters {
  std::uint64_t used = 0;         ///< passed to the estimator
  std::uint64_t without_imu = 0;  ///< before the first sample of the IMU
  /// Their last bytes came so late that they may belong to the next packet: if the magic word after
  /// lost bytes is damaged as well, nothing else shows the loss, since the packets have no
  /// checksum.
  std::uint64_t made_up = 0;
  /// Their measurement time is unknown (FrameClock::odd): the host stalled for a second, or the
  /// radar has just restarted.
  std::uint64_t untimed = 0;
};

struct SessionSetup {
  Options options;
  std::vector<ti::FrameTiming> radars;  ///< one for each radar of the options
  bool imu_on_host_clock = false;       ///< the samples are stamped in the clock of the arrivals
};

class Session {
 public:
  /// Throws std::runtime_error if options or timing are invalid.
  /// @param listeners are called in this order, and must outlive the session
  Session(const SessionSetup& setup, std::vector<Listener*> listeners);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Bytes of a radar's data port.
  void radar(std::size_t r, const std::uint8_t* bytes, std::size_t count, Time arrival);
  /// The port of a radar was reopened.
  void radar_reopened(std::size_t r) { radars_[r].reader.drop_pending(); }
  /// No byte will come any more: closes the listeners.
  void end();
  /// A sample of the IMU.
  void imu(const ImuSample& sample, Time arrival);
  /// The offset of the clocks, if known better than from the arrivals of the samples.
  void tell_host_offset(Time offset) { configured_offset_ = offset; }

  const Odometry& odometry() const { return *odometry_; }
  /// What listeners threw; empty if none did.
  const std::string& failed() const { return failed_; }
  std::size_t radars() const { return radars_.size(); }
  const ti::PacketReader& reader(std::size_t r) const { return radars_[r].reader; }
  /// Clock of the arrivals minus that of the IMU.
  Time host_offset() const;
  const FrameCounters& frames(std::size_t r) const { return radars_[r].frames; }
  /// What is wrong with the times of most frames of a radar, and what to do; empty if nothing is.
  std::string times_problem(std::size_t r) const;
  std::uint64_t imu_samples() const { return imu_samples_; }
  /// This machine's clock minus that of the stamps of the IMU, which are said to be in it; zero if
  /// they are in another.
  Time imu_stamps_off() const { return imu_on_host_clock_ ? offset_.offset() : Time{0}; }
  /// How long no sample has come, at the newest frame of a radar: since the newest sample, or since
  /// the first frame if there is none.
  Time imu_silence() const { return newest_frame_ - newest_imu_; }

 private:
  struct Radar {
    ti::FrameTiming timing;
    ti::PacketReader reader;
    ti::FrameClock clock;
    FrameCounters frames;
    std::uint32_t number = 0;    ///< of the newest frame
    std::uint32_t subframe = 0;  ///< same
    bool has_subframes = false;
  };
  /// A scan that may still be waiting in the estimator.
  struct Pending {
    Time stamp{0};
    Time arrival{0};
  };

  void take(std::size_t r, ti::Frame* frame);
  void flush_held(Time now);
  void flush(std::size_t r);
  bool is_left_out(Radar* radar, ti::Frame* frame);
  void tell_estimate() noexcept;
  template <class Call>
  void tell(const Call& call);

  std::unique_ptr<Odometry> odometry_;
  std::vector<Radar> radars_;
  std::vector<Listener*> listeners_;
  bool imu_on_host_clock_;
  ClockOffset offset_;
  std::optional<Time> configured_offset_;
  std::array<Pending, 64> pending_{};  ///< ring buffer
  std::size_t next_pending_ = 0;
  std::string failed_;
  std::uint64_t imu_samples_ = 0;
  Time newest_imu_{0};    ///< arrival of the newest sample; of the first frame if there is none
  Time newest_frame_{0};  ///< same of the newest frame
};

/// Says, once, why a radar gives no scans, or none with the right times.
class ScanWatch {
 public:
  static constexpr Time kPatience = std::chrono::seconds(10);

  /// Call it some times a second.
  /// @param now real time
  /// @param times Session::times_problem()
  /// @return what to say: at once a cause that three packets tell, others after ten seconds without
  /// a scan, and that the scans are back; mostly empty
  std::string look(const ti::PacketReader& reader, Time now, const std::string& times = {});

 private:
  Time since_{0};          ///< without a scan
  ti::PacketCounters at_;  ///< then
  bool waits_ = false;     ///< since the first look
  bool timed_ = false;     ///< that times are wrong was said
  bool silent_ = false;    ///< that there is no scan was said
  ti::StreamState said_ = ti::StreamState::kSilent;
};

}  // namespace rio::live
