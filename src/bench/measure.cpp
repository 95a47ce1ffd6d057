// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "rio/eval/metrics.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/io/simulation.hpp"
#include "rio/rio.hpp"

namespace rio::bench {

namespace {

constexpr double kUsual = 20.0;  ///< points that hardly any scan of the default scenario misses

/// The room and radar of the default scenario, finer if more points are needed.
sim::Scenario scenario_of(std::size_t detections, double seconds) {
  sim::Scenario s;
  s.max_duration = s.path.stand_before + seconds;
  const double more = std::max(1.0, static_cast<double>(detections) / kUsual);
  for (double* density : {&s.room.floor_density, &s.room.wall_density, &s.room.ceiling_density,
                          &s.room.clutter_density}) {
    *density *= more;
  }
  s.radar.max_static = static_cast<int>(std::ceil(1.2 * static_cast<double>(detections)));
  s.radar.range_resolution /= std::sqrt(more);
  s.radar.doppler_resolution /= std::sqrt(more);
  s.radar.snr_1m_db += 15.0 * std::log10(more);
  return s;
}

void keep_strongest(std::size_t count, RadarScan* scan) {
  if (scan->detections.size() <= count) return;
  std::stable_sort(
      scan->detections.begin(), scan->detections.end(),
      [](const RadarDetection& a, const RadarDetection& b) { return a.snr_db > b.snr_db; });
  scan->detections.resize(count);
}

/// CPU time of this thread, so that other load does not count.
Time cpu_now() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

double microseconds(Time t) {
  return 1e6 * to_seconds(t);
}

/// Heap memory of this process in bytes; 0 if unknown.
std::size_t heap_in_use() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

std::unique_ptr<Odometry> create(const Options& options) {
  std::string why;
  auto odometry = Odometry::create(options, &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  return odometry;
}

/// [us]
double time_of_create(const Options& options) {
  std::vector<double> times;
  for (int i = 0; i < 9; ++i) {
    const Time before = cpu_now();
    const auto odometry = create(options);
    times.push_back(microseconds(cpu_now() - before));
  }
  return eval::statistics(std::move(times)).median;
}

class Run {
 public:
  Run(const io::Dataset& load, const Options& options) : load_(load) {
    const std::size_t before = heap_in_use();
    odometry_ = create(options);
    figures_.memory = heap_in_use() - before;
  }

  Figures figures() {
    const Time begin = cpu_now();
    auto scan = load_.scans.begin();
    for (const ImuSample& sample : load_.imu) {
      for (; scan != load_.scans.end() && scan->time < sample.time; ++scan) {
        (void)odometry_->add_scan(*scan);  // waits for the sample; dropped before the start
      }
      (void)odometry_->add_imu(sample);
      ++samples_;
      record();
    }
    return conclude(cpu_now() - begin);
  }

 private:
  /// Whether the sample caused a scan to be processed.
  void record() {
    const UpdateReport& report = odometry_->report();
    if (report.time == last_) return;
    last_ = report.time;
    if (!report.at_rest && report.status == Status::kOk) {
      updates_.push_back(microseconds(report.update_time));
      propagation_ += report.propagation_time;
      propagated_ += samples_;
      figures_.detections += report.detections_kept;
      figures_.clones += report.clones;
      figures_.landmarks += report.landmarks;
    }
    samples_ = 0;
  }

  Figures conclude(Time spent) {
    if (updates_.empty()) throw std::runtime_error("no scan was processed in flight");
    const auto count = static_cast<double>(updates_.size());
    figures_.updates = updates_.size();
    figures_.detections /= count;
    figures_.clones /= count;
    figures_.landmarks /= count;
    figures_.imu_step = microseconds(propagation_) / static_cast<double>(propagated_);
    figures_.real_time =
        to_seconds(load_.imu.back().time - load_.imu.front().time) / to_seconds(spent);
    std::sort(updates_.begin(), updates_.end());
    figures_.update = {updates_[updates_.size() / 2], updates_[(updates_.size() * 99) / 100]};
    return figures_;
  }

  const io::Dataset& load_;
  std::unique_ptr<Odometry> odometry_;
  Figures figures_;
  std::vector<double> updates_;  ///< [us]
  Time last_{0};                 ///< scan of the last report
  Time propagation_{0};
  std::size_t propagated_ = 0;  ///< samples in it
  std::size_t samples_ = 0;     ///< since the last scan
};

}  // namespace

io::Dataset make_load(std::size_t detections, double seconds) {
  io::Dataset load = io::dataset_of(sim::simulate_flight(scenario_of(detections, seconds)));
  for (RadarScan& scan : load.scans) keep_strongest(detections, &scan);
  return load;
}

Figures measure(const io::Dataset& load, const Options& options) {
  Options timed = options;
  timed.timing.clock = &cpu_now;
  const double create_time = time_of_create(timed);
  Figures figures = Run(load, timed).figures();
  figures.create = create_time;
  return figures;
}

Options options_for(const io::Dataset& load, const std::string& preset_name, BackEnd backend) {
  Options options = io::preset_named(preset_name);
  io::apply_sensor_info(load, &options);
  options.backend = backend;
  return options;
}

}  // namespace rio::bench
