// SPDX-License-Identifier: BSD-3-Clause
// Statistics of `rio live`: the status line, and the summary at the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "live/host_clock.hpp"
#include "live/imu_stream.hpp"
#include "live/session.hpp"
#include "replay_summary.hpp"

namespace rio::tools {

class LiveSummary : public live::Listener {
 public:
  explicit LiveSummary(const live::HostClock& clock) : clock_(clock) {}

  void on_imu(const live::Session& session, const ImuSample& sample) override;
  void on_estimate(const live::Session& session, Time arrival) override;

  /// One status line, without newline.
  std::string line(const live::Session& session) const;

  /// At the end.
  /// @param radar_ports what is wrong with the port of each radar, if no byte came; or empty
  /// @param imu_problem why samples are missing; empty if none are
  /// @return whether the estimate is lost
  bool conclude(const live::Session& session, const std::vector<std::string>& radar_ports,
                const live::ImuCounters& imu, const std::string& imu_problem,
                std::uint64_t odometry_sent);
  std::string text() const;
  std::string json() const;
  const ReplaySummary& replay() const { return replay_; }
  const std::string& lost_because() const { return replay_.health.lost_because(); }
  /// Of each radar without usable scans, or few of many, and why; empty if all have them.
  const std::string& without_scans() const { return replay_.without_scans; }

 private:
  /// @param share 0.5 the median
  /// @return 0 if there is none
  double latency_ms(double share) const;

  const live::HostClock& clock_;
  ReplaySummary replay_;
  std::vector<float> latencies_;  ///< of the estimates [s]
  std::optional<Time> newest_;    ///< sample
  double cpu_share_ = 0.0;
  /// Of a radar, at the end.
  struct Radar {
    ti::PacketCounters packets;
    live::FrameCounters frames;
    std::string firmware;  ///< of the newest points
    std::string problem;   ///< empty if there is none
  };
  static Radar end_of(const live::Session& session, std::size_t r);

  std::vector<Radar> radars_;
  Radar all_;  ///< their sums
  live::ImuCounters imu_;
  std::string imu_problem_;
  std::uint64_t odometry_sent_ = 0;
};

}  // namespace rio::tools
