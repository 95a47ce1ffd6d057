// SPDX-License-Identifier: BSD-3-Clause
// The catalogue of faults.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "experiment/fault.hpp"
#include "rio/core/so3.hpp"

namespace rio::experiment {

namespace {

// ---- faults of stamps, order and arrival

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

void shift(Event& e, Time by) {
  (e.is_imu() ? e.sample.time : e.scan.time) += by;
}

ChangeEvent shifted(Time by) {
  return [by](Event& e, Moment&) { shift(e, by); };
}

/// The stamps of the first events of a kind.
ChangeEvent first(int count, Time by) {
  return [count, by](Event& e, Moment& m) {
    if (m.n < count) shift(e, by);
  };
}

/// The first stamps of a kind, `apart` events apart.
ChangeEvent two_set(int apart, Time first, Time second) {
  return [=](Event& e, Moment& m) {
    Time& stamp = e.is_imu() ? e.sample.time : e.scan.time;
    if (m.n == 0) stamp = first;
    if (m.n == apart) stamp = second;
  };
}

void start_at_0(Event& e, Moment& m) {
  shift(e, -m.begin);
}

ChangeEvent jittering(double sigma) {
  return [sigma](Event& e, Moment& m) { shift(e, from_seconds(sigma * m.random.normal())); };
}

ChangeEvent late(double by) {
  return [by](Event& e, Moment&) { e.arrival += from_seconds(by); };
}

/// All of a kind arrive together at the end of each block.
ChangeEvent in_blocks(double block) {
  return [block](Event& e, Moment& m) {
    e.arrival = m.begin + from_seconds(block * (std::floor(m.t / block) + 1.0));
  };
}

/// Every second one arrives after its successor.
void swap(Event& e, Moment& m) {
  if (m.n % 2 == 1) return;
  const sim::Scenario& sensors = m.flight.scenario;
  e.arrival += from_seconds(1.5 / (e.is_imu() ? sensors.imu.rate_hz : sensors.radar.rate_hz));
}

/// The same event once more.
ChangeEvent again(double after) {
  return [after](Event& e, Moment& m) {
    m.more.push_back(e);
    m.more.back().arrival += from_seconds(after);
  };
}

void lose(Event& e, Moment&) {
  e.lost = true;
}

std::vector<Fault> time_faults() {
  constexpr Promise kIgnored = Promise::kIgnored;
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kReported = Promise::kReported;
  constexpr Of kImu = Of::kImu;
  constexpr Of kScans = Of::kScans;
  constexpr Of kBoth = Of::kBoth;
  // after a rotation in an unnoticed pause of the IMU of some 0.3 s the Dopplers show it soon
  const Promised soon = recovered(2.0);
  const Promised in_the_end = recovered(10.0);
  return {
      {"one IMU stamp +1 h", kImu, 1.0, kIgnored, first(1, hours(1))},
      {"one IMU stamp +10 s", kImu, 1.0, kIgnored, first(1, seconds(10))},
      {"one IMU stamp -1 h", kImu, 1.0, kIgnored, first(1, -hours(1))},
      {"ten IMU stamps +1 h in a row", kImu, 1.0, kIgnored, first(10, hours(1))},
      {"nine scan stamps +1 h", kScans, 1.0, kIgnored, first(9, hours(1))},
      {"nine scan stamps +0.9 s", kScans, 1.0, kBridged, first(9, milliseconds(900))},
      {"IMU stamps at both ends of time", kImu, 1.0, kIgnored,
       two_set(10, Time::max(), Time::min())},
      {"scan stamps at both ends of time", kScans, 1.0, kIgnored,
       two_set(1, Time::min(), Time::max())},
      {"all clocks start again at 0", kBoth, kForGood, soon, start_at_0},
      {"all clocks jump by 1 h", kBoth, kForGood, soon, shifted(hours(1))},
      {"all clocks go back by 0.3 s", kBoth, kForGood, soon, shifted(-milliseconds(300))},
      {"all clocks jump by 2 s", kBoth, kForGood, kHonest, shifted(seconds(2))},
      {"the radar's clock late by 0.05 s", kScans, kForGood, kHonest, shifted(milliseconds(50))},
      {"the radar's clock late by 0.2 s", kScans, kForGood, soon, shifted(milliseconds(200))},
      {"the radar's clock early by 0.2 s", kScans, kForGood, soon, shifted(-milliseconds(200))},
      {"the radar's clock late by 0.3 s", kScans, kForGood, soon, shifted(milliseconds(300))},
      {"the radar's clock early by 0.3 s", kScans, kForGood, soon, shifted(-milliseconds(300))},
      {"the radar's clock starts again at 0", kScans, kForGood, soon, start_at_0},
      {"IMU stamps jitter by 2 ms for 10 s", kImu, 10.0, kBridged, jittering(2e-3)},
      {"scan stamps jitter by 20 ms for 10 s", kScans, 10.0, kBridged, jittering(20e-3)},
      {"IMU samples twice for 10 s", kImu, 10.0, kIgnored, again(0.0)},
      {"IMU samples again after 0.3 s", kImu, 10.0, kIgnored, again(0.3)},
      {"scans twice for 10 s", kScans, 10.0, kIgnored, again(0.0)},
      {"scans again after 0.3 s", kScans, 10.0, kIgnored, again(0.3)},
      {"IMU samples swapped for 10 s", kImu, 10.0, kBridged, swap},
      {"scans swapped for 10 s", kScans, 10.0, kBridged, swap},
      {"scans 0.1 s late for 10 s", kScans, 10.0, kBridged, late(0.1)},
      {"scans 0.9 s late for 10 s", kScans, 10.0, kBridged, late(0.9)},
      {"scans 1.5 s late for 10 s", kScans, 10.0, kHonest, late(1.5)},
      {"IMU 0.1 s late for 10 s", kImu, 10.0, kBridged, late(0.1)},
      // in the end newer samples overtake the late ones, which are lost: a pause of 0.9 s
      {"IMU 0.9 s late for 10 s", kImu, 10.0, in_the_end, late(0.9)},
      {"IMU in blocks of 0.1 s for 10 s", kImu, 10.0, kBridged, in_blocks(0.1)},
      {"IMU in blocks of 0.5 s for 10 s", kImu, 10.0, kBridged, in_blocks(0.5)},
      {"scans in blocks of 0.5 s for 10 s", kScans, 10.0, kBridged, in_blocks(0.5)},
      {"scans in blocks of 2 s for 10 s", kScans, 10.0, kBridged, in_blocks(2.0)},
      {"IMU silent for 0.01 s", kImu, 0.01, kBridged, lose},
      {"IMU silent for 0.03 s", kImu, 0.03, kBridged, lose},
      {"IMU silent for 0.1 s", kImu, 0.1, kBridged, lose},
      {"IMU silent for 0.3 s", kImu, 0.3, soon, lose},
      {"IMU silent for 1 s", kImu, 1.0, in_the_end, lose},
      {"IMU silent for 2 s", kImu, 2.0, in_the_end, lose},
      {"IMU silent for 5 s", kImu, 5.0, in_the_end, lose},
      {"IMU silent for good", kImu, kForGood, kReported, lose},
      {"radar silent for 0.5 s", kScans, 0.5, kBridged, lose},
      {"radar silent for 1 s", kScans, 1.0, kBridged, lose},
      {"radar silent for 2 s", kScans, 2.0, kBridged, lose},
      {"radar silent for 5 s", kScans, 5.0, kBridged, lose},
      {"radar silent for 10 s", kScans, 10.0, kHonest, lose},
      {"radar silent for 30 s", kScans, 30.0, kHonest, lose},
      {"radar silent for 60 s", kScans, 60.0, kHonest, lose},
      {"radar silent for 120 s", kScans, 120.0, kHonest, lose},
      {"radar silent for good", kScans, kForGood, kReported, lose},
      {"IMU and radar silent for 0.3 s", kBoth, 0.3, soon, lose},
      {"IMU and radar silent for 1 s", kBoth, 1.0, in_the_end, lose},
      {"IMU and radar silent for 5 s", kBoth, 5.0, in_the_end, lose},
      {"IMU and radar silent for 30 s", kBoth, 30.0, in_the_end, lose},
      {"IMU and radar silent for 120 s", kBoth, 120.0, in_the_end, lose},
  };
}

// ---- faults of the IMU data

using ChangeSample = std::function<void(ImuSample&, Moment&)>;

Fault samples(const char* name, double duration, Promised promised, const ChangeSample& change) {
  return {name, Of::kImu, duration, promised,
          [change](Event& e, Moment& m) { change(e.sample, m); }};
}

/// The first sample alone.
Fault one_sample(const char* name, Promised promised,
                 const std::function<void(ImuSample&)>& change) {
  return samples(name, 1.0, promised, [change](ImuSample& s, Moment& m) {
    if (m.n == 0) change(s);
  });
}

void freeze_gyro(ImuSample& s, Moment& m) {
  s.gyro_B = m.before.sample.gyro_B;
}
void freeze_accel(ImuSample& s, Moment& m) {
  s.accel_B = m.before.sample.accel_B;
}
void freeze(ImuSample& s, Moment& m) {
  freeze_gyro(s, m);
  freeze_accel(s, m);
}
ChangeSample reading(double gyro, double accel) {
  return [gyro, accel](ImuSample& s, Moment&) {
    s.gyro_B.setConstant(gyro);
    s.accel_B.setConstant(accel);
  };
}
void spike(ImuSample& s, Moment& m) {
  if (m.random.uniform() > 0.01) return;
  s.accel_B += 50.0 * m.random.normal3().normalized();
  s.gyro_B += 10.0 * m.random.normal3().normalized();
}
void vibrate(ImuSample& s, Moment& m) {
  s.accel_B += 30.0 * m.random.normal3();
  s.gyro_B += 1.0 * m.random.normal3();
}
ChangeSample gyro_bias(int axis, double step) {
  return [axis, step](ImuSample& s, Moment&) { s.gyro_B[axis] += step; };
}
ChangeSample accel_bias(int axis) {
  return [axis](ImuSample& s, Moment&) { s.accel_B[axis] += 0.5; };
}

std::vector<Fault> imu_faults() {
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kIgnored = Promise::kIgnored;
  const Promised brief = recovered(2.0);
  const Promised soon = recovered(5.0);
  const Promised later = recovered(10.0);
  const Promised learned = recovered(15.0);
  const ChangeSample full_scale = reading(34.9, 156.9);
  std::vector<Fault> all = {
      samples("gyro NaN for 0.2 s", 0.2, brief, [](auto& s, auto&) { s.gyro_B.x() = NAN; }),
      samples("accel NaN for 0.2 s", 0.2, brief, [](auto& s, auto&) { s.accel_B.z() = NAN; }),
      samples("gyro infinite for 0.2 s", 0.2, brief,
              [](auto& s, auto&) { s.gyro_B.y() = INFINITY; }),
      samples("accel infinite for 0.2 s", 0.2, brief,
              [](auto& s, auto&) { s.accel_B.x() = -INFINITY; }),
      samples("IMU of NaN for 2 s", 2.0, later, [](auto& s, auto&) { s.gyro_B.setConstant(NAN); }),
      samples("IMU frozen for 0.1 s", 0.1, brief, freeze),
      samples("IMU frozen for 0.5 s", 0.5, soon, freeze),
      samples("IMU frozen for 2 s", 2.0, later, freeze),
      samples("IMU at full scale for 0.02 s", 0.02, kBridged, full_scale),
      samples("IMU at full scale for 0.5 s", 0.5, soon, full_scale),
      one_sample("one sample of 1e299 rad/s", kIgnored,
                 [](ImuSample& s) { s.gyro_B.setConstant(1e299); }),
      one_sample("one sample of 1e4 m/s^2", kIgnored, [](ImuSample& s) { s.accel_B.z() = 1e4; }),
      one_sample("one sample of 100 m/s^2", soon, [](ImuSample& s) { s.accel_B.x() = 100.0; }),
      one_sample("one sample of 30 rad/s", later, [](ImuSample& s) { s.gyro_B.x() = 30.0; }),
      samples("1 % of spikes of 50 m/s^2, 10 rad/s for 10 s", 10.0, later, spike),
      samples("all values 0 for 2 s", 2.0, later, reading(0.0, 0.0)),
      samples("gyro x reads 0 for 5 s", 5.0, later, [](auto& s, auto&) { s.gyro_B.x() = 0.0; }),
      samples("gyro z reads 0 for 5 s", 5.0, kHonest, [](auto& s, auto&) { s.gyro_B.z() = 0.0; }),
      samples("accel z stuck for 5 s", 5.0, later,
              [](auto& s, auto& m) { s.accel_B.z() = m.before.sample.accel_B.z(); }),
      samples("accel frozen for 5 s", 5.0, later, freeze_accel),
      samples("gyro frozen for 5 s", 5.0, later, freeze_gyro),
      samples("accel reads 0 for 5 s", 5.0, later, [](auto& s, auto&) { s.accel_B.setZero(); }),
      samples("vibration of 3 g and 1 rad/s for 10 s", 10.0, later, vibrate),
      samples("gyro bias x +0.01 rad/s", kForGood, learned, gyro_bias(0, 0.01)),
      samples("gyro bias y +0.01 rad/s", kForGood, learned, gyro_bias(1, 0.01)),
      // only landmarks distinguish a rotation about the vertical from a bias
      samples("gyro bias z +0.01 rad/s", kForGood, kHonest, gyro_bias(2, 0.01)),
      samples("accel bias x +0.5 m/s^2", kForGood, learned, accel_bias(0)),
      samples("accel bias y +0.5 m/s^2", kForGood, learned, accel_bias(1)),
      samples("accel bias z +0.5 m/s^2", kForGood, learned, accel_bias(2)),
      samples("gyro bias x +0.05 rad/s", kForGood, learned, gyro_bias(0, 0.05)),
      samples("gyro bias x creeps by 1e-3 rad/s^2", 20.0, learned,
              [](auto& s, auto& m) { s.gyro_B.x() += 1e-3 * m.t; }),
  };
  for (const double hz : {10.0, 25.0, 50.0, 100.0, 500.0, 2000.0, 8000.0}) {
    all.push_back({.name = fmt::format("IMU at {} Hz", hz),
                   .duration = kForGood,
                   .promised = hz < 50.0 ? kHonest : kBridged,
                   .sensors = [hz](sim::Scenario& s) { s.imu.rate_hz = hz; }});
  }
  return all;
}

// ---- faults of the radar data

using ChangeScan = std::function<void(RadarScan&, Moment&)>;
using ChangePoint = std::function<void(RadarDetection&, Moment&)>;

Fault scans(const std::string& name, double duration, Promised promised, const ChangeScan& change) {
  return {name, Of::kScans, duration, promised,
          [change](Event& e, Moment& m) { change(e.scan, m); }};
}

/// A share of the points.
Fault points(const std::string& name, double duration, Promised promised, double share,
             const ChangePoint& change) {
  return scans(name, duration, promised, [share, change](RadarScan& scan, Moment& m) {
    for (RadarDetection& d : scan.detections) {
      if (m.random.uniform() < share) change(d, m);
    }
  });
}

/// One field of all detections, in turn NaN, infinite and absurd.
Fault bad_field(const char* name, double RadarDetection::*field) {
  return points(fmt::format("{} NaN, infinite, 1e200 for 1 s", name), 1.0, Promise::kBridged, 1.0,
                [field](RadarDetection& d, Moment& m) {
                  constexpr std::array<double, 4> kBad = {NAN, INFINITY, 1e200, -INFINITY};
                  d.*field = kBad[static_cast<std::size_t>(m.n) % kBad.size()];
                });
}

/// A point somewhere in view with random motion.
RadarDetection anything(const sim::RadarModel& radar, sim::Random& random) {
  const double range = random.uniform(0.5, 0.8 * radar.max_range);
  const double azimuth = random.uniform(-0.5, 0.5) * radar.fov_azimuth;
  const double elevation = random.uniform(-0.5, 0.5) * radar.fov_elevation;
  RadarDetection d;
  d.point_S = range * Vector3d(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  d.range_rate = random.uniform(-radar.max_doppler, radar.max_doppler);
  d.snr_db = radar.threshold_db + random.uniform(0.0, 20.0);
  return d;
}

void replace(RadarDetection& d, Moment& m) {
  d = anything(m.flight.scenario.radar, m.random);
}

void add_velocity(const Vector3d& velocity_S, RadarDetection& d, Moment& m) {
  const double ambiguity = 2.0 * m.flight.scenario.radar.max_doppler;
  d.range_rate = std::remainder(d.range_rate + velocity_S.dot(d.point_S.normalized()), ambiguity);
}

/// A common velocity, like a lorry that fills the view.
void move_together(RadarDetection& d, Moment& m) {
  add_velocity({0.6, 0.5, 0.0}, d, m);
}

/// The velocity of one of four bodies; a body is a sector of the view.
void move_in_four(RadarDetection& d, Moment& m) {
  const double azimuth = std::atan2(d.point_S.y(), d.point_S.x());
  const double body = std::floor(4.0 * (azimuth / m.flight.scenario.radar.fov_azimuth + 0.5));
  const double heading = 1.0 + 2.0 * body + 0.2 * m.t;
  add_velocity({std::cos(heading), std::sin(heading), 0.0}, d, m);
}

/// "80 % random outliers for 3 s".
Fault outliers(const char* what, double share, double duration, Promised promised,
               const ChangePoint& change) {
  return points(fmt::format("{:.0f} % {} for {} s", 100.0 * share, what, duration), duration,
                promised, share, change);
}

Fault many_detections(const char* name, Promised promised, double stronger_db, bool same_room) {
  return scans(name, 10.0, promised, [stronger_db, same_room](RadarScan& scan, Moment& m) {
    constexpr std::size_t kMany = 5000;
    const sim::RadarModel& radar = m.flight.scenario.radar;
    const std::size_t real = scan.detections.size();
    if (real == 0) return;
    while (scan.detections.size() < kMany) {
      RadarDetection d =
          same_room ? scan.detections[scan.detections.size() % real] : anything(radar, m.random);
      if (same_room) {  // an echo that spreads over its neighbours
        d.point_S += 0.02 * d.point_S.norm() * m.random.normal3();
        d.range_rate += radar.sigma_doppler * m.random.normal();
      }
      d.snr_db += stronger_db;
      scan.detections.push_back(d);
    }
  });
}

std::vector<Fault> radar_faults() {
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  const Promised soon = recovered(5.0);
  const Promised later = recovered(10.0);
  std::vector<Fault> all = {
      points("points NaN for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto& m) { d.point_S[m.n % 3] = NAN; }),
      points("points of 1e200 m for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto&) { d.point_S *= 1e200; }),
      points("points at 0 for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto&) { d.point_S.setZero(); }),
      bad_field("range rate", &RadarDetection::range_rate),
      bad_field("SNR", &RadarDetection::snr_db),
      bad_field("noise floor", &RadarDetection::noise_db),
      bad_field("sigma of the range", &RadarDetection::sigma_range),
      bad_field("sigma of the azimuth", &RadarDetection::sigma_azimuth),
      bad_field("sigma of the elevation", &RadarDetection::sigma_elevation),
      bad_field("sigma of the Doppler", &RadarDetection::sigma_doppler),
  };
  for (const double s : {1.0, 5.0, 15.0, 30.0}) {
    all.push_back(scans(fmt::format("empty scans for {} s", s), s, s < 10.0 ? kBridged : kHonest,
                        [](RadarScan& scan, Moment&) { scan.detections.clear(); }));
  }
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(scans(fmt::format("the same scan again for {} s", s), s, later,
                        [](auto& scan, auto& m) { scan.detections = m.before.scan.detections; }));
  }
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(outliers("random outliers", 0.8, s, s < 10.0 ? kBridged : soon, replace));
  }
  all.push_back(outliers("random outliers", 1.0, 10.0, soon, replace));
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(outliers("coherent outliers", 0.6, s, soon, move_together));
    all.push_back(outliers("coherent outliers", 1.0, s, later, move_together));
  }
  for (const double share : {0.5, 0.7, 0.9}) {
    all.push_back(outliers("movers", share, 10.0, share > 0.5 ? soon : kBridged, move_in_four));
  }
  all.push_back(many_detections("5000 detections, noise", kBridged, -20.0, false));
  all.push_back(many_detections("5000 detections, strong noise", soon, 20.0, false));
  all.push_back(many_detections("5000 detections of the same room", kBridged, 0.0, true));
  for (const double hz : {1.0, 2.0, 5.0, 30.0, 60.0}) {
    all.push_back({.name = fmt::format("radar at {} Hz", hz),
                   .duration = kForGood,
                   .promised = hz < 5.0 ? kHonest : kBridged,
                   .sensors = [hz](sim::Scenario& s) { s.radar.rate_hz = hz; }});
  }
  return all;
}

// ---- faults of the configuration: mounting, and starts in flight

constexpr double kDegree = M_PI / 180.0;

Fault wrong_mounting(const std::string& by, Promised promised,
                     const std::function<void(Pose&)>& change) {
  return {.name = "mounting wrong by " + by,
          .duration = kForGood,
          .promised = promised,
          .configure = [change](Options& o) { change(o.radar.T_BS); }};
}

Fault turned_mounting(double degrees, Promised promised) {
  return wrong_mounting(fmt::format("{} deg", degrees), promised, [degrees](Pose& T_BS) {
    const Vector3d axis = Vector3d(1.0, 1.0, 1.0).normalized();
    T_BS.rotation = (T_BS.rotation * quaternion_exp(degrees * kDegree * axis)).normalized();
  });
}

using Start = io::StartFile;

/// A start in flight from the truth with the sigmas of the options' start, modified.
Fault start(const std::string& name, Promised promised, const std::function<void(Start&)>& change) {
  const double duration = promised.promise == Promise::kIgnored ? 1.0 : kForGood;
  return {"start in flight, " + name, Of::kImu, duration, promised, [change](Event& e, Moment& m) {
            if (m.n != 0) return;
            auto start = std::make_shared<Start>();
            start->state = m.flight.truth_at(e.measured);
            start->covariance = io::start_covariance(start->state.q_WB, StartOptions{});
            change(*start);
            m.more.push_back({.arrival = e.arrival,
                              .measured = e.measured,
                              .kind = Event::Kind::kReset,
                              .start = start});
          }};
}

/// An error of `size` in one component, with the start's sigma (lying) or its own size (honest).
Fault off(const char* what, int component, double size, bool honest, Promised promised) {
  return start(fmt::format("{} off, sigma {}", what, honest ? "honest" : "lying"), promised,
               [component, size, honest](Start& s) {
                 const Eigen::Matrix<double, body::kSize, 1> error =
                     size * Eigen::Matrix<double, body::kSize, 1>::Unit(component);
                 s.state.q_WB = s.state.q_WB * quaternion_exp(error.segment<3>(body::kAttitude));
                 s.state.p_WB += error.segment<3>(body::kPosition);
                 s.state.v_WB += error.segment<3>(body::kVelocity);
                 s.state.gyro_bias += error.segment<3>(body::kGyroBias);
                 s.state.accel_bias += error.segment<3>(body::kAccelBias);
                 if (honest) s.covariance(component, component) = size * size;
               });
}

/// Errors of a start, first with an honest sigma and then with a lying one.
struct StartError {
  const char* what;
  int component;
  double size;
  double honest_within;  ///< time of recovery [s]
  double lying_within;   ///< same
};
constexpr StartError kStartErrors[] = {
    {"5 deg of roll", body::kAttitude, 5.0 * kDegree, 10.0, 15.0},
    {"20 deg of roll", body::kAttitude, 20.0 * kDegree, 10.0, 15.0},
    {"90 deg of roll", body::kAttitude, 90.0 * kDegree, 20.0, 20.0},
    {"1 m/s", body::kVelocity, 1.0, 5.0, 15.0},
    {"5 m/s", body::kVelocity, 5.0, 5.0, 15.0},
    {"gyro bias 0.05 rad/s", body::kGyroBias, 0.05, 10.0, 15.0},
    {"accel bias 0.5 m/s^2", body::kAccelBias, 0.5, 10.0, 15.0}};

std::vector<Fault> configuration_faults() {
  std::vector<Fault> all = {
      turned_mounting(5.0, Promise::kHonest),
      turned_mounting(20.0, Promise::kReported),
      turned_mounting(90.0, Promise::kReported),
      turned_mounting(180.0, Promise::kReported),
      wrong_mounting("0.3 m", Promise::kHonest, [](Pose& T_BS) { T_BS.translation.x() += 0.3; }),
      off("1 m", body::kPosition, 1.0, true, Promise::kHonest),
      off("20 deg of yaw", body::kAttitude + 2, 20.0 * kDegree, true, recovered(10.0)),
  };
  for (const StartError& e : kStartErrors) {
    all.push_back(off(e.what, e.component, e.size, true, recovered(e.honest_within)));
    all.push_back(off(e.what, e.component, e.size, false, recovered(e.lying_within)));
  }
  /// Refused.
  const auto impossible = [&all](const char* name, const std::function<void(Start&)>& change) {
    all.push_back(start(name, Promise::kIgnored, change));
  };
  impossible("velocity NaN", [](Start& s) { s.state.v_WB.x() = NAN; });
  impossible("quaternion zero", [](Start& s) { s.state.q_WB.coeffs().setZero(); });
  impossible("quaternion of 1e200", [](Start& s) { s.state.q_WB.coeffs() *= 1e200; });
  impossible("time 0", [](Start& s) { s.state.time = Time{0}; });
  impossible("covariance NaN", [](Start& s) { s.covariance(3, 3) = NAN; });
  impossible("covariance indefinite", [](Start& s) { s.covariance(3, 3) = -1.0; });
  return all;
}

// ---- all

const Fault& named(const std::vector<Fault>& all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const Fault& f) { return f.name == name; });
  if (found == all.end()) throw std::runtime_error(fmt::format("no such fault: \"{}\"", name));
  return *found;
}

std::vector<Fault> make_catalogue() {
  std::vector<Fault> all = {{.name = "none", .promised = Promise::kIgnored}};
  for (const auto& group : {time_faults, imu_faults, radar_faults, configuration_faults}) {
    for (Fault& fault : group()) all.push_back(std::move(fault));
  }
  const auto pair = [&all](std::string_view a, std::string_view b, Promised promised) {
    all.push_back(together(named(all, a), named(all, b), promised));
  };
  pair("radar silent for 5 s", "IMU silent for 0.3 s", recovered(5.0));
  pair("radar silent for 10 s", "all clocks start again at 0", Promise::kHonest);
  pair("radar silent for 10 s", "gyro bias x +0.01 rad/s", recovered(15.0));
  pair("empty scans for 5 s", "IMU frozen for 0.5 s", recovered(5.0));
  pair("empty scans for 5 s", "accel bias x +0.5 m/s^2", recovered(15.0));
  pair("80 % random outliers for 3 s", "gyro bias y +0.01 rad/s", recovered(15.0));
  pair("80 % random outliers for 3 s", "one sample of 100 m/s^2", recovered(5.0));
  pair("60 % coherent outliers for 3 s", "IMU silent for 0.3 s", recovered(5.0));
  pair("70 % movers for 10 s", "IMU samples swapped for 10 s", Promise::kBridged);
  pair("70 % movers for 10 s", "gyro bias z +0.01 rad/s", Promise::kHonest);
  return all;
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = make_catalogue();
  return all;
}

const Fault& fault_named(std::string_view name) {
  return named(faults(), name);
}

}  // namespace rio::experiment
