// SPDX-License-Identifier: BSD-3-Clause
#include "live_summary.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rio::tools {

namespace {

Time cpu_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& t) {
    return std::chrono::seconds(t.tv_sec) + std::chrono::microseconds(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

ti::PacketCounters packets_of(const live::Session& session) {
  ti::PacketCounters sum;
  for (std::size_t r = 0; r < session.radars(); ++r) {
    const ti::PacketCounters& one = session.reader(r).counters();
    sum.frames += one.frames;
    sum.lost += one.lost;
    sum.damaged += one.damaged;
    sum.other_sdk += one.other_sdk;
    sum.bytes_skipped += one.bytes_skipped;
  }
  return sum;
}

}  // namespace

void LiveSummary::on_imu(const live::Session& session, const ImuSample& sample) {
  const Odometry& odometry = session.odometry();
  if (replay_.span == Time{0}) first_ = sample.time;
  replay_.span = std::max(Time{1}, sample.time - first_);
  if (odometry.initialized()) replay_.health.add(sample.time, odometry.health());
}

void LiveSummary::on_estimate(const live::Session& session, Time arrival) {
  latencies_.add(clock_.to_real(clock_.now() - arrival));
  replay_.add(session.odometry().report(), session.odometry().at_scan());
}

std::string LiveSummary::line(const live::Session& session) const {
  const Odometry& odometry = session.odometry();
  const ti::PacketCounters packets = packets_of(session);
  std::string state;
  if (session.imu_samples() == 0) {
    state = "no IMU yet";
  } else if (!odometry.initialized()) {
    state = "hold still";
  } else {
    const Vector3d& p = odometry.now().p_WB;
    state = fmt::format("{} {} %  [{:.2f} {:.2f} {:.2f}] m  {:.2f} m/s  {} of {} points",
                        to_string(odometry.health().state), odometry.health().quality, p.x(), p.y(),
                        p.z(), odometry.now().v_WB.norm(), odometry.report().static_detections,
                        odometry.report().detections);
  }
  if (packets.frames == 0)
    state += fmt::format("  radar: {}", to_string(session.reader(0).state()));
  return fmt::format("{:7.1f} s  {}  scans {} lost {} damaged {}  {:.2f} ms",
                     to_seconds(replay_.span), state, packets.frames, packets.lost, packets.damaged,
                     1e3 * latencies_.quantile(0.5));
}

bool LiveSummary::conclude(const live::Session& session, const live::ImuCounters& imu,
                           std::uint64_t odometry_sent) {
  const Odometry& odometry = session.odometry();
  packets_ = packets_of(session);
  imu_ = imu;
  frames_made_up_ = session.frames_made_up();
  frames_untimed_ = session.frames_untimed();
  odometry_sent_ = odometry_sent;
  replay_.initialised_by = odometry.initialized() ? "static" : "never: it was not held still";
  replay_.counters = odometry.counters();
  replay_.scans = static_cast<int>(replay_.counters.scans);  // of two in one call one is seen
  replay_.scans_before_start = static_cast<int>(replay_.counters.scans_uninitialized);
  replay_.wall = cpu_time();
  cpu_share_ = to_seconds(replay_.wall) / to_seconds(clock_.to_real(replay_.span));
  replay_.health.conclude(replay_.calibration, replay_.is_absurd());
  return replay_.health.lost();
}

std::string LiveSummary::text() const {
  return fmt::format(
             "last byte to estimate: {:.3f} ms median, {:.3f} ms p99; {:.1f} % of a core\n"
             "radar: {} packets, {} lost, {} damaged, {} made up, {} of unknown time; IMU: {} "
             "samples, {} lost, {} "
             "damaged; ODOMETRY: {} sent\n",
             1e3 * latencies_.quantile(0.5), 1e3 * latencies_.quantile(0.99), 100.0 * cpu_share_,
             packets_.frames, packets_.lost, packets_.damaged, frames_made_up_, frames_untimed_,
             imu_.samples, imu_.lost, imu_.damaged, odometry_sent_) +
         replay_.text();
}

std::string LiveSummary::json() const {
  auto all = nlohmann::ordered_json::parse(replay_.json());
  all["live"] = {{"latency_median_ms", 1e3 * latencies_.quantile(0.5)},
                 {"latency_p99_ms", 1e3 * latencies_.quantile(0.99)},
                 {"cpu_share", cpu_share_},
                 {"packets", packets_.frames},
                 {"packets_lost", packets_.lost},
                 {"packets_damaged", packets_.damaged},
                 {"packets_made_up", frames_made_up_},
                 {"packets_untimed", frames_untimed_},
                 {"imu_samples", imu_.samples},
                 {"imu_lost", imu_.lost},
                 {"imu_damaged", imu_.damaged},
                 {"odometry_sent", odometry_sent_}};
  return all.dump();
}

}  // namespace rio::tools
