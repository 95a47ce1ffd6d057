// SPDX-License-Identifier: BSD-3-Clause
#include "live_summary.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "json_line.hpp"

namespace rio::tools {

namespace {

constexpr Time kLongestPause = std::chrono::minutes(1);  // more is a step of the clock
constexpr std::uint64_t kNearlyAll = 10;                 // damaged packets to one that is whole

Time cpu_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& t) {
    return std::chrono::seconds(t.tv_sec) + std::chrono::microseconds(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

void add(const ti::PacketCounters& one, ti::PacketCounters* sum) {
  sum->frames += one.frames;
  sum->lost += one.lost;
  sum->damaged += one.damaged;
}

}  // namespace

void LiveSummary::on_imu(const live::Session& session, const ImuSample& sample) {
  const Odometry& odometry = session.odometry();
  const Time step = newest_ ? sample.time - *newest_ : Time{0};
  if (step > Time{0} && step < kLongestPause) replay_.span += step;
  newest_ = sample.time;
  replay_.health.add(sample.time, odometry.health());
}

void LiveSummary::on_estimate(const live::Session& session, Time arrival) {
  const Time latency = clock_.to_real(clock_.now() - arrival);
  latencies_.push_back(static_cast<float>(to_seconds(latency)));
  replay_.add(session.odometry().report(), session.odometry().at_scan());
}

double LiveSummary::latency_ms(double share) const {
  if (latencies_.empty()) return 0.0;
  std::vector<float> sorted = latencies_;
  const auto at = sorted.begin() + std::lround(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return 1e3 * static_cast<double>(*at);
}

std::string LiveSummary::line(const live::Session& session) const {
  const Odometry& odometry = session.odometry();
  ti::PacketCounters packets;
  std::string silent;
  for (std::size_t r = 0; r < session.radars(); ++r) {
    const ti::PacketReader& reader = session.reader(r);
    add(reader.counters(), &packets);
    if (reader.counters().frames > 0) continue;
    silent += fmt::format("  radar {}: {}", r, to_string(reader.state()));
  }
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
  return fmt::format("{:7.1f} s  {}{}  scans {} lost {} damaged {}  {:.2f} ms",
                     to_seconds(replay_.span), state, silent, packets.frames, packets.lost,
                     packets.damaged, latency_ms(0.5));
}

LiveSummary::Radar LiveSummary::end_of(const live::Session& session, std::size_t r) {
  const ti::PacketReader& reader = session.reader(r);
  const ti::Firmware* firmware = reader.firmware();
  Radar radar{reader.counters(), session.frames(r), firmware == nullptr ? "" : firmware->name,
              reader.problem()};
  const live::FrameCounters& frames = radar.frames;
  const std::uint64_t most = std::max({frames.without_imu, frames.made_up, frames.untimed});
  if (radar.problem.empty()) radar.problem = session.times_problem(r);
  if (radar.problem.empty() && frames.used == 0) {
    radar.problem = fmt::format("no packet is used: {}",
                                most == frames.without_imu ? "they came before the IMU"
                                : most == frames.made_up   ? "their bytes come too slowly"
                                                           : "their arrival fits no frame rate");
  }
  return radar;
}

bool LiveSummary::conclude(const live::Session& session,
                           const std::vector<std::string>& radar_ports,
                           const live::ImuCounters& imu, const std::string& imu_problem,
                           std::uint64_t odometry_sent) {
  const Odometry& odometry = session.odometry();
  for (std::size_t r = 0; r < session.radars(); ++r) {
    Radar radar = end_of(session, r);
    if (radar.packets.bytes == 0 && !radar_ports[r].empty()) radar.problem = radar_ports[r];
    add(radar.packets, &all_.packets);
    all_.frames.made_up += radar.frames.made_up;
    all_.frames.untimed += radar.frames.untimed;
    const auto& [packets, frames, firmware, problem] = radar;
    const bool of_little_use = frames.untimed + frames.made_up > frames.used ||
                               packets.damaged > kNearlyAll * packets.frames ||
                               replay_.updates == 0;
    if (packets.points == 0 || frames.used == 0 || (of_little_use && !problem.empty())) {
      replay_.without_scans +=
          fmt::format("{}radar {}: {}", replay_.without_scans.empty() ? "" : "; ", r, problem);
    }
    radars_.push_back(radar);
  }
  imu_ = imu;
  imu_problem_ = imu_problem;
  odometry_sent_ = odometry_sent;
  replay_.initialised_by = odometry.initialized()       ? start_name(odometry.counters())
                           : session.imu_samples() == 0 ? "never: no sample of the IMU came"
                                                        : "never: it found no standstill";
  replay_.counters = odometry.counters();
  replay_.scans_before_start = static_cast<int>(replay_.counters.scans_uninitialized);
  replay_.wall = cpu_time();
  if (replay_.span > Time{0}) {
    cpu_share_ = to_seconds(replay_.wall) / to_seconds(clock_.to_real(replay_.span));
  }
  replay_.health.conclude(replay_.calibration, replay_.is_absurd(), 1.0, imu_problem);
  return replay_.health.lost();
}

std::string LiveSummary::text() const {
  std::string text = fmt::format(
      "last byte to estimate: {:.3f} ms median, {:.3f} ms p99; {:.1f} % of a core\n"
      "radar: {} packets, {} lost, {} damaged, {} made up, {} of unknown time; IMU: {} samples, {} "
      "lost, {} damaged; ODOMETRY: {} sent\n",
      latency_ms(0.5), latency_ms(0.99), 100.0 * cpu_share_, all_.packets.frames, all_.packets.lost,
      all_.packets.damaged, all_.frames.made_up, all_.frames.untimed, imu_.samples, imu_.lost,
      imu_.damaged, odometry_sent_);
  for (std::size_t r = 0; r < radars_.size(); ++r) {
    const auto& [packets, frames, firmware, problem] = radars_[r];
    text += fmt::format(
        "radar {}: {} packets, {} points, {} not finite, {} lost, {} damaged, {} cut short, "
        "{} of other firmware{}{}\n",
        r, packets.frames, packets.points, packets.points_left_out, packets.lost, packets.damaged,
        packets.cut_short, packets.other_sdk, problem.empty() ? "" : "; ", problem);
  }
  return text + replay_.text();
}

std::string LiveSummary::json() const {
  auto all = nlohmann::ordered_json::parse(replay_.json());
  auto radars = nlohmann::ordered_json::array();
  for (const auto& [packets, frames, firmware, problem] : radars_) {
    radars.push_back({{"packets", packets.frames},
                      {"points", packets.points},
                      {"points_not_finite", packets.points_left_out},
                      {"lost", packets.lost},
                      {"damaged", packets.damaged},
                      {"other_firmware", packets.other_sdk},
                      {"cut_short", packets.cut_short},
                      {"bytes", packets.bytes},
                      {"bytes_skipped", packets.bytes_skipped},
                      {"used", frames.used},
                      {"without_imu", frames.without_imu},
                      {"made_up", frames.made_up},
                      {"untimed", frames.untimed},
                      {"firmware", firmware},
                      {"problem", problem}});
  }
  all["live"] = {{"latency_median_ms", latency_ms(0.5)},
                 {"latency_p99_ms", latency_ms(0.99)},
                 {"cpu_share", cpu_share_},
                 {"packets", all_.packets.frames},
                 {"packets_lost", all_.packets.lost},
                 {"packets_damaged", all_.packets.damaged},
                 {"packets_made_up", all_.frames.made_up},
                 {"packets_untimed", all_.frames.untimed},
                 {"imu_samples", imu_.samples},
                 {"imu_lost", imu_.lost},
                 {"imu_damaged", imu_.damaged},
                 {"imu_problem", imu_problem_},
                 {"odometry_sent", odometry_sent_},
                 {"radars", radars}};
  return json_line(all);
}

}  // namespace rio::tools
