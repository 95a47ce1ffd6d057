// SPDX-License-Identifier: BSD-3-Clause
// Time of one scan at full load: 30 detections, N = 10 clones or states; with `published-ekf` 10
// landmarks and 20 trails as long as they get, with `default` as many landmarks as it may have; and
// of its parts. The ratio of the back-ends: smoother/default_update over ekf/default_update.
#include <benchmark/benchmark.h>

#include <memory>

#include "rio/ekf/ekf.hpp"
#include "rio/pipeline.hpp"
#include "rio/smoother/smoother.hpp"

namespace rio {
namespace {

constexpr int kDetections = 30;
constexpr Time kScanPeriod{66'666'667};
constexpr Time kImuPeriod{5'000'000};

/// A radar that swings to and fro before thirty points, all of them always in view: neither rest
/// nor repeated scans spare work.
template <class BackEnd>
class FullLoad {
 public:
  explicit FullLoad(const char* name)
      : options_(make_options(name)), imu_(options_.timing, options_.imu) {
    pipeline_ = std::make_unique<Pipeline<BackEnd>>(options_);
    NavState start;
    start.v_WB = velocity(Time{0});
    pipeline_->reset(start, BodyCovariance(BodyCovariance::Identity() * 1e-4));
    // the first ten points live long enough to become landmarks; the others are replaced in turn,
    // so that their trails stay just short of promotion
    for (int i = 0; i < 30; ++i) process();
  }

  void process() {
    ++scan_;
    const Time time = scan_ * kScanPeriod;
    for (; imu_time_ < time + kImuPeriod; imu_time_ += kImuPeriod) {
      imu_.push_back(
          {imu_time_, Vector3d::Zero(), acceleration(imu_time_) + Vector3d(0.0, 0.0, 9.81)});
    }
    filter_detections(scan(time), options_.radar, options_.frontend.max_detections, list_);
    if (pipeline_->process(list_, imu_) != Status::kOk) std::abort();
    imu_.forget_before(time);
  }
  const UpdateReport& report() const { return pipeline_->report(); }

 private:
  static Options make_options(const char* name) {
    Options o;
    if (!preset(name, &o)) std::abort();
    if (o.update.use_trails) {  // the load of the paper
      o.update.max_clones = 10;
      o.update.max_landmarks = 10;
      o.frontend.promote_after = 10;
    }
    o.timing.clock = [] { return Time(std::chrono::steady_clock::now().time_since_epoch()); };
    return o;
  }
  // Of the body: 0.3 m, 2 rad/s, along x.
  static constexpr double kSwing = 0.3;
  static constexpr double kRate = 2.0;
  static Vector3d position(Time t) {
    return kSwing * std::sin(kRate * to_seconds(t)) * Vector3d::UnitX();
  }
  static Vector3d velocity(Time t) {
    return kSwing * kRate * std::cos(kRate * to_seconds(t)) * Vector3d::UnitX();
  }
  static Vector3d acceleration(Time t) { return -kRate * kRate * position(t); }

  RadarScan scan(Time time) const {
    RadarScan s{time, {}};
    for (int i = 0; i < kDetections; ++i) {
      const double azimuth = 0.06 * (i - 15);
      const double elevation = 0.2 * std::sin(1.7 * i);
      const Vector3d u(std::cos(elevation) * std::cos(azimuth),
                       std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Vector3d point = (3.0 + 0.2 * (i % 7)) * u - position(time);
      s.detections.push_back({point, -point.normalized().dot(velocity(time)), 20.0, 0.0});
    }
    return s;
  }

  Options options_;
  ImuBuffer imu_;
  std::unique_ptr<Pipeline<BackEnd>> pipeline_;
  DetectionList list_;
  Time imu_time_{0};
  std::int64_t scan_ = 0;
};

/// Front-end to promotion, or the propagation over the 13 or 14 IMU samples of a scan period.
template <class BackEnd>
void stage(benchmark::State& state, const char* name, Time UpdateReport::*spent) {
  FullLoad<BackEnd> load(name);
  for (auto _ : state) {
    load.process();
    state.SetIterationTime(to_seconds(load.report().*spent));
  }
  const UpdateReport& r = load.report();
  state.counters["clones"] = r.clones;
  state.counters["landmarks"] = r.landmarks;
  double rows = 0.0;
  for (const ModelReport& model : r.models) rows += model.rows_used + model.rows_gated;
  state.counters["rows"] = rows;
}
void ekf(benchmark::State& state, const char* name, Time UpdateReport::*spent) {
  stage<Ekf>(state, name, spent);
}
void smoother(benchmark::State& state, const char* name, Time UpdateReport::*spent) {
  stage<Smoother>(state, name, spent);
}
BENCHMARK_CAPTURE(ekf, default_update, "default", &UpdateReport::update_time)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(smoother, default_update, "default", &UpdateReport::update_time)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ekf, published_ekf_update, "published-ekf", &UpdateReport::update_time)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ekf, propagation, "default", &UpdateReport::propagation_time)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace rio

BENCHMARK_MAIN();
