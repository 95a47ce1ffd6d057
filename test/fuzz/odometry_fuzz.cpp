// SPDX-License-Identifier: BSD-3-Clause
// The calls of rio.hpp in any order with any data. The bytes are a program: options, then commands
// to a vehicle that flies well but for what they spoil, so that most inputs reach an estimate.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include "fuzz/judge.hpp"
#include "fuzz/vehicle.hpp"
#include "rio/models/aids.hpp"

namespace rio::fuzz {

namespace {

constexpr int kMaxCalls = 3000;  // of one input

constexpr Time::rep kMost = std::numeric_limits<Time::rep>::max();
constexpr Time::rep kLeast = std::numeric_limits<Time::rep>::min();

/// The sum, at the ends of the integers at most.
Time later(Time time, Time by) {
  if (by.count() > 0 && time.count() > kMost - by.count()) return Time(kMost);
  if (by.count() < 0 && time.count() < kLeast - by.count()) return Time(kLeast);
  return time + by;
}

/// Of stamps: from a nanosecond to the ends of the integers.
Time odd_duration(Input& in) {
  constexpr Time::rep kMs = 1'000'000, kS = 1000 * kMs, kAge = 4'700'000'000 * kS;
  constexpr Time::rep kOdd[] = {
      0,          1,          -1,         kMs,        -kMs,        30 * kMs, -30 * kMs, 150 * kMs,
      -150 * kMs, 600 * kMs,  -600 * kMs, 1100 * kMs, -1100 * kMs, 9 * kS,   11 * kS,   -11 * kS,
      3600 * kS,  -3600 * kS, kAge,       -kAge,      kMost,       kLeast};
  return Time(in.one_of(kOdd));
}

/// Carries out the commands.
class Program {
 public:
  Program(Input& in, std::unique_ptr<Odometry> odometry, const Options& options)
      : in_(in),
        vehicle_(options),
        judge_(std::move(odometry), options),
        further_(options.radars() > 1) {
    constexpr Time::rep kEpochs[] = {1'700'000'000'000'000'000, 0, -5'000'000'000,
                                     4'611'686'018'000'000'000};
    const int start = in_.byte();
    clock_ = Time(kEpochs[start % 4]);
    period_ = start & 4 ? 0.0025 : 0.01;
    if (start & 8) return;  // aligns itself, if the options let it
    run(5);
    reset_to_truth();
  }

  void run_all() {
    while (!in_.empty() && steps_ < kMaxCalls) command(in_.byte());
  }

 private:
  void command(int code) {
    switch (code % 16) {
      default:
        run(1 + in_.byte() % 100);
        break;
      case 4:
        odd_imu();
        break;
      case 5:
        stamp_error_ = odd_duration(in_);
        step();
        stamp_error_ = Time{0};
        break;
      case 6:
        clock_ = later(clock_, odd_duration(in_));
        break;
      case 7:
        t_ += 0.05 * in_.byte();  // silence
        break;
      case 8:
        odd_scan();
        break;
      case 9:
        crowded_scan();
        break;
      case 10:
        judge_.reset();
        break;
      case 11:
        reset_to_truth();
        break;
      case 12:
        odd_reset();
        break;
      case 13:
        (in_.byte() % 2 ? gyro_error_ : accel_error_)[in_.below(3)] = 1e-3 * in_.word();
        break;
      case 14:
        doppler_error_[in_.below(3)] = 0.1 * static_cast<std::int8_t>(in_.byte());
        break;
      case 15:
        scan_every_ = in_.byte();
        early_ = 0.01 * in_.below(12);
        break;
    }
  }

  void run(int samples) {
    for (int i = 0; i < samples && steps_ < kMaxCalls; ++i) step();
  }

  /// One period of the IMU; some periods, a scan, which may come before its time.
  void step() {
    ++steps_;
    t_ += period_;
    (void)judge_.add_imu(imu());
    if (scan_every_ > 0 && steps_ % scan_every_ == 0) (void)judge_.add_scan(scan());
    if (!further_) return;
    if (steps_ % 5 == 0) further_scan();
    if (steps_ % 4 == 0) aid();
  }

  /// Of the second radar, which looks backwards: its points turned, not its Dopplers.
  void further_scan() {
    RadarScan scan = this->scan();
    scan.time = later(scan.time, Time(-1'000'000 * (steps_ % 40)));
    (void)judge_.add_scan(scan, 1 + (steps_ % 50 == 0 ? 1 : 0));
  }

  /// A height, a position, a heading or a velocity, some of them absurd or late.
  void aid() {
    const double wrong = steps_ % 28 == 0 ? 1e3 * (doppler_error_.x() + 1.0) : 0.0;
    const double t = t_ - (steps_ % 24 == 0 ? 0.2 : 0.0);
    const NavState x = vehicle_.state(t);
    const Time time = stamp(t);
    switch (steps_ / 4 % 5) {
      case 0:
        (void)judge_.add_measurement({time, HeightModel{}, {x.p_WB.z() + wrong, 0.1}});
        break;
      case 1:
        (void)judge_.add_measurement({time, PositionModel{}, {x.p_WB}});
        break;
      case 2:
        (void)judge_.add_measurement({time, HeadingModel{}, {wrong, 0.1 + wrong * wrong}});
        break;
      case 3:
        (void)judge_.add_measurement({time, WorldVelocityModel{}, {x.v_WB}});
        break;
      default:
        (void)judge_.add_measurement({time, GroundRangeModel{}, {wrong, 0.1}});  // undeclared
        break;
    }
  }

  ImuSample imu() {
    ImuSample sample = vehicle_.imu(t_);
    sample.time = stamp(t_);
    sample.gyro_B += gyro_error_;
    sample.accel_B += accel_error_;
    return sample;
  }
  RadarScan scan() {
    const double t = t_ + early_ - 0.3 * period_;
    RadarScan scan = vehicle_.scan(t, doppler_error_);
    scan.time = stamp(t);
    return scan;
  }
  Time stamp(double t) const { return later(later(clock_, from_seconds(t)), stamp_error_); }

  void odd_imu() {
    t_ += period_;
    ImuSample sample = imu();
    for (int n = 1 + in_.below(3); n > 0; --n) {
      (in_.byte() % 2 ? sample.gyro_B : sample.accel_B)[in_.below(3)] = in_.real();
    }
    (void)judge_.add_imu(sample);
    if (in_.byte() % 4 == 0) (void)judge_.add_imu(sample);
  }

  void odd_scan() {
    RadarScan scan = this->scan();
    if (in_.byte() % 2) scan.time = later(scan.time, odd_duration(in_));
    for (int n = in_.below(16); n > 0 && !scan.detections.empty(); --n) {
      RadarDetection& d = scan.detections[in_.byte() % scan.detections.size()];
      double* const fields[] = {&d.point_S.x(),   &d.point_S.y(),   &d.point_S.z(),
                                &d.range_rate,    &d.snr_db,        &d.noise_db,
                                &d.sigma_range,   &d.sigma_azimuth, &d.sigma_elevation,
                                &d.sigma_doppler, &d.point_S.x()};
      *in_.one_of(fields) = in_.real();
    }
    (void)judge_.add_scan(scan);
    if (in_.byte() % 4 == 0) (void)judge_.add_scan(scan);
  }

  /// None, one and the same, or more than any capacity.
  void crowded_scan() {
    RadarScan scan = this->scan();
    const std::size_t count = in_.byte() % 4 ? in_.byte() % 8 : 300;
    const std::vector<RadarDetection> one = std::move(scan.detections);
    scan.detections.clear();
    const std::size_t kinds = std::min<std::size_t>(one.size(), 1 + in_.byte() % 32);
    for (std::size_t i = 0; kinds > 0 && i < count; ++i) {
      scan.detections.push_back(one[i % kinds]);
    }
    (void)judge_.add_scan(scan);
  }

  void reset_to_truth() {
    NavState x = vehicle_.state(t_);
    x.time = stamp(t_);
    (void)judge_.reset(x, start_covariance());
  }

  static BodyCovariance start_covariance() {
    BodyCovariance P = BodyCovariance::Identity() * 1e-4;
    P.diagonal().segment<3>(body::kVelocity).setConstant(0.01);
    P.diagonal().segment<3>(body::kGyroBias).setConstant(1e-6);
    return P;
  }

  void odd_reset() {
    NavState x = vehicle_.state(t_);
    x.time = later(stamp(t_), odd_duration(in_));
    BodyCovariance P = start_covariance();
    double* const fields[] = {&x.q_WB.x(),      &x.q_WB.w(),     &x.p_WB[0],      &x.p_WB[2],
                              &x.v_WB[0],       &x.v_WB[2],      &x.gyro_bias[0], &x.gyro_bias[2],
                              &x.accel_bias[1], &x.accel_bias[2]};
    for (int n = in_.below(4); n > 0; --n) {
      *in_.one_of(fields) = in_.real();
    }
    for (int n = in_.below(4); n > 0; --n) {
      const int row = in_.below(body::kSize);
      const int column = in_.byte() % 2 ? row : in_.below(body::kSize);
      P(row, column) = P(column, row) = in_.real();
    }
    if (in_.byte() % 16 == 0) P(3, 4) = in_.real();
    (void)judge_.reset(x, P);
  }

  Input& in_;
  Vehicle vehicle_;
  Judge judge_;
  bool further_;  ///< sensors
  Time clock_{0};
  Time stamp_error_{0};
  double t_ = 0.0;  ///< [s]
  double period_ = 0.01;
  double early_ = 0.0;  ///< scans come before the IMU has reached them [s]
  int scan_every_ = 7;  ///< IMU samples
  int steps_ = 0;
  Vector3d gyro_error_ = Vector3d::Zero();
  Vector3d accel_error_ = Vector3d::Zero();
  Vector3d doppler_error_ = Vector3d::Zero();
};

void print_calls() {
  std::fprintf(stderr,
               "calls: %lu add_imu, %lu add_scan (%lu processed), %lu add_measurement, %lu reset\n",
               calls.add_imu, calls.add_scan, calls.processed, calls.aiding, calls.reset);
}

}  // namespace

}  // namespace rio::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rio::fuzz;
  [[maybe_unused]] static const int once = std::atexit(print_calls);
  Input in(data, size);
  const rio::Options options = options_of(in);
  const bool valid = options.validate();
  std::string why;
  std::unique_ptr<rio::Odometry> odometry;
  {
    const TrapFloatingPoint trap(valid);
    odometry = rio::Odometry::create(options, &why);
  }
  RIO_FUZZ_CHECK((odometry != nullptr) == valid);
  RIO_FUZZ_CHECK(valid == why.empty());
  if (valid) Program(in, std::move(odometry), options).run_all();
  return 0;
}
