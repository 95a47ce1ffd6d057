// SPDX-License-Identifier: BSD-3-Clause
#include "checked_part.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rio::tools {

namespace {

void add_notes(const check::ClockSteps& steps, const char* way_out,
               std::vector<std::string>* notes) {
  const auto add = [&](const std::vector<check::ClockStep>& of, const std::string& sensor,
                       const char* item) {
    for (const check::ClockStep& step : of) {
      notes->push_back(fmt::format(
          "the clock of {} steps by {:+.3f} s at {} {}: taken out of its later stamps{}", sensor,
          to_seconds(step.size), item, step.first + 1, way_out));
    }
  };
  add(steps.imu, "the IMU", "sample");
  for (std::size_t r = 0; r < steps.radars.size(); ++r) {
    add(steps.radars[r], fmt::format("radar{}", r), "scan");
  }
}

}  // namespace

CheckedPart read_checked_part(io::RecordingStream* stream, const io::Dataset& sensors) {
  constexpr double kLongest = 600.1;              // ten minutes, and the error of a clock [s]
  constexpr double kPause = 1.0;                  // of the IMU, not counted [s]
  constexpr std::size_t kMostBytes = 20'000'000;  // of samples and scans
  CheckedPart part{{sensors, {}, {}}, std::nullopt};
  // reserved at once: a growing vector exists twice; untouched memory costs nothing
  part.data.imu.reserve(std::min(stream->outline().imu_samples, kMostBytes / sizeof(ImuSample)));
  for (const std::vector<Time>& stamps : stream->outline().scan_times) {
    part.data.radars.emplace_back().reserve(stamps.size(), kMostBytes / sizeof(check::Point));
  }
  std::size_t bytes = 0;
  double seconds = 0.0;
  const auto full = [&] { return bytes > kMostBytes || seconds > kLongest; };
  ReplayFeed feed(stream);
  while (!full()) {
    const ImuSample* sample = feed.imu();
    const std::optional<Time> due = feed.due();
    if (sample == nullptr && !due) break;
    if (due && (sample == nullptr || *due < sample->time)) {
      std::size_t radar = 0;
      const RadarScan& scan = feed.take_scan(&radar);
      bytes += check::Scans::bytes(scan);
      if (!full()) part.data.radars[radar].push_back(scan);
    } else {
      if (!part.data.imu.empty()) {
        const double step = to_seconds(sample->time) - to_seconds(part.data.imu.back().time);
        if (step > 0.0 && step < kPause) seconds += step;
      }
      bytes += sizeof(ImuSample);
      if (!full()) part.data.imu.push_back(*sample);
      feed.pass_imu();
    }
  }
  if (full()) part.seconds = seconds;
  stream->rewind();  // closes the files
  return part;
}

check::ClockSteps find_clock_steps(io::RecordingStream* stream, const io::Dataset& sensors,
                                   const Options& options, std::vector<std::string>* notes) {
  const io::RecordingOutline& outline = stream->outline();
  if (!outline.imu_odd && std::ranges::all_of(outline.scan_times, [](const auto& stamps) {
        return check::possible_steps(stamps).empty();
      })) {
    return {};
  }
  const CheckedPart part = read_checked_part(stream, sensors);
  check::ClockSteps steps =
      check::find_clock_steps(part.data.imu, part.data.radars, sensors.imu_info, options);
  add_notes(steps, " (--no-check flies them as recorded)", notes);
  return steps;
}

void take_out_clock_steps(const Options& options, io::Dataset* dataset) {
  std::vector<std::vector<RadarScan>*> radars = {&dataset->scans};
  for (io::Dataset::OtherRadar& other : dataset->other_radars) radars.push_back(&other.scans);
  std::vector<check::Scans> scans;
  for (const std::vector<RadarScan>* of : radars) scans.emplace_back(*of);
  const check::ClockSteps steps =
      check::find_clock_steps(dataset->imu, scans, dataset->imu_info, options);
  dataset->imu = check::without_steps(std::move(dataset->imu), steps.imu);
  for (std::size_t r = 0; r < radars.size(); ++r) {
    for (std::size_t i = 0; i < radars[r]->size(); ++i) {
      Time& stamp = (*radars[r])[i].time;
      stamp = check::without_steps(stamp, steps.radars[r], i);
    }
  }
  add_notes(steps, "", &dataset->notes);
}

}  // namespace rio::tools
