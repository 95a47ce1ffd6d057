// SPDX-License-Identifier: BSD-3-Clause
#include "replay_feed.hpp"

#include <algorithm>

namespace rio::tools {

namespace {

constexpr double kLongest = 600.1;              // ten minutes, and the error of a clock [s]
constexpr std::size_t kMostBytes = 20'000'000;  // of samples and scans

}  // namespace

CheckedPart::CheckedPart(const io::Dataset& sensors, const io::RecordingOutline& outline)
    : data_{sensors, {}, {}} {
  // reserved at once: a growing vector exists twice; untouched memory costs nothing
  for (const std::vector<Time>& stamps : outline.scan_times) {
    data_.radars.emplace_back().reserve(stamps.size(), kMostBytes / sizeof(check::Point));
  }
}

void CheckedPart::add(const ImuSample& sample) {
  constexpr double kPause = 1.0;  // [s]
  if (full_) return;
  if (imu_samples_ > 0) {
    const double step = to_seconds(sample.time) - to_seconds(last_);
    if (step > 0.0 && step < kPause) seconds_ += step;
  }
  bytes_ += sizeof(ImuSample);
  full_ = seconds_ > kLongest || bytes_ > kMostBytes;
  last_ = sample.time;
  imu_samples_ += full_ ? 0 : 1;
}

void CheckedPart::add(const RadarScan& scan, std::size_t radar) {
  if (full_) return;
  bytes_ += check::Scans::bytes(scan);
  full_ = bytes_ > kMostBytes;
  if (!full_) data_.radars[radar].push_back(scan);
}

const check::CheckedData& CheckedPart::read(io::RecordingStream* stream) {
  stream->rewind();
  data_.imu.resize(imu_samples_);
  std::size_t count = 0;
  while (count < imu_samples_ && stream->next(&data_.imu[count])) ++count;
  data_.imu.resize(count);
  stream->rewind();  // closes the files
  return data_;
}

std::optional<double> CheckedPart::seconds() const {
  return full_ ? std::optional<double>(seconds_) : std::nullopt;
}

std::optional<std::vector<Time>> due_times(const std::vector<Time>& stamps) {
  if (std::is_sorted(stamps.begin(), stamps.end())) return std::nullopt;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> ends;  // last scan of the best sequence of each length
  std::vector<std::size_t> before(stamps.size(), kNone);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto at =
        std::upper_bound(ends.begin(), ends.end(), stamps[i],
                         [&stamps](Time time, std::size_t end) { return time < stamps[end]; });
    if (at != ends.begin()) before[i] = *(at - 1);
    if (at == ends.end()) {
      ends.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<Time> due(stamps.size());
  std::size_t in_order = ends.back();
  Time next = stamps[in_order];
  for (std::size_t i = stamps.size(); i-- > 0;) {
    if (i == in_order) {
      next = stamps[i];
      in_order = before[i];
    }
    due[i] = next;
  }
  return due;
}

ReplayFeed::ReplayFeed(io::RecordingStream* stream, CheckedPart* kept)
    : stream_(stream), kept_(kept) {
  for (const std::vector<Time>& stamps : stream->outline().scan_times) {
    radars_.push_back({&stamps, due_times(stamps)});
  }
  stream->rewind();
}

const ImuSample* ReplayFeed::imu(std::size_t ahead) {
  while (samples_ <= ahead) {
    if (samples_ > 0) imu_[0] = imu_[1];
    if (!stream_->next(&imu_[1])) {
      if (samples_ > 0) imu_[1] = imu_[0];
      return nullptr;
    }
    ++samples_;
    if (kept_ != nullptr) kept_->add(imu_[1]);
  }
  return &imu_[2 - samples_ + ahead];
}

std::size_t ReplayFeed::first_due() const {
  std::size_t first = radars_.size();
  for (std::size_t r = 0; r < radars_.size(); ++r) {
    if (!radars_[r].any()) continue;
    if (first == radars_.size() || radars_[r].due() < radars_[first].due()) first = r;
  }
  return first;
}

std::optional<Time> ReplayFeed::due() const {
  const std::size_t r = first_due();
  if (r == radars_.size()) return std::nullopt;
  return radars_[r].due();
}

const RadarScan& ReplayFeed::take_scan(std::size_t* radar) {
  *radar = first_due();
  Radar& of = radars_[*radar];
  if (!stream_->next(&scan_, *radar)) {  // the file has been cut meanwhile
    scan_ = {};
    of.count = of.next + 1;
  }
  ++of.next;
  if (kept_ != nullptr) kept_->add(scan_, *radar);
  return scan_;
}

std::size_t ReplayFeed::scans_left() const {
  std::size_t left = 0;
  for (const Radar& radar : radars_) left += radar.count - radar.next;
  return left;
}

void ReplayFeed::read_rest() {
  if (kept_ == nullptr) return;
  while (kept_->open() && imu() != nullptr) pass_imu();
  for (std::size_t radar = 0; kept_->open() && due();) (void)take_scan(&radar);
}

}  // namespace rio::tools
